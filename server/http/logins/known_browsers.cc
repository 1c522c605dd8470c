#include "server/http/logins/known_browsers.h"

#include "server/base/digests/hmac.h"
#include "server/base/digests/secret.h"

namespace rigcal::http {
namespace {
constexpr std::size_t kHalf = 32;  // hex digits: which browser, and the signature
}

KnownBrowsers::KnownBrowsers() : key_(NewSecret()) {}

std::string KnownBrowsers::SignedFor(const std::string& browser, const std::string& name) const {
  return browser + HmacSha256(key_, browser + " " + name).str().substr(0, kHalf);
}

std::string KnownBrowsers::MarkFor(const std::string& name) const {
  return SignedFor(NewSecret().substr(0, kHalf), name);
}

bool KnownBrowsers::Has(const std::string& mark, const std::string& name) const {
  return mark.size() == 2 * kHalf && IsSameSecret(mark, SignedFor(mark.substr(0, kHalf), name));
}

}  // namespace rigcal::http

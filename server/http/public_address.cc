#include "server/http/public_address.h"

#include <unistd.h>

#include <array>
#include <string_view>

#include "server/base/text.h"

namespace rigcal::http {
namespace {

constexpr std::string_view kHostCharacters = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-";
constexpr std::string_view kAlsoInUrls = "_~:/[]%";
constexpr std::size_t kUrlBytesMax = 1024;

bool IsMadeOf(std::string_view text, std::string_view characters, std::string_view and_these = "") {
  for (const char c : text)
    if (characters.find(c) == std::string_view::npos && and_these.find(c) == std::string_view::npos) return false;
  return !text.empty();
}

bool IsEveryAddress(const std::string& host) { return host == "0.0.0.0" || host == "[::]"; }

}  // namespace

Result<std::string> ReadPublicUrl(const std::string& given) {
  const std::size_t scheme = given.rfind("https://", 0) == 0 ? 8 : given.rfind("http://", 0) == 0 ? 7 : 0;
  const std::string rest = given.substr(scheme);
  const bool has_host = !rest.empty() && rest.front() != '/' && rest.front() != ':';
  if (scheme == 0 || !has_host || given.size() > kUrlBytesMax || !IsMadeOf(rest, kHostCharacters, kAlsoInUrls))
    return Fail(ErrorCode::kInvalidInput, "the public address " + Quoted(given) + " is not one",
                "Write, for instance, --public-url http://rigs.example.org:8420.");
  return given.substr(0, given.find_last_not_of('/') + 1);
}

std::string AddressOf(const Options& options, int port, const std::string& machine) {
  const std::string name = IsMadeOf(machine, kHostCharacters) ? machine : "127.0.0.1";
  return (options.certificate ? "https://" : "http://") + (IsEveryAddress(options.host) ? name : options.host) + ":" +
         std::to_string(port);
}

std::string MachineName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace rigcal::http

#include "client/upkeep/support/server_pages.h"

#include <curl/curl.h>

#include <memory>

namespace rigcal::client {
namespace {

constexpr std::size_t kPageBytesMax = 16 << 20;
constexpr long kPageMax_ms = 10'000;

// Ends the transfer where the page is larger than any of ours.
std::size_t AppendTo(char* data, std::size_t size, std::size_t count, void* text) {
  auto& kept = *static_cast<std::string*>(text);
  if (kept.size() + size * count > kPageBytesMax) return 0;
  kept.append(data, size * count);
  return size * count;
}

struct FreeHeaders {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using Headers = std::unique_ptr<curl_slist, FreeHeaders>;

Headers HeadersWith(const std::string& token) {
  return Headers(token.empty() ? nullptr : curl_slist_append(nullptr, ("Authorization: Bearer " + token).c_str()));
}

}  // namespace

Result<std::string> PageText(const std::string& address, const std::string& path, const std::string& token) {
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl(curl_easy_init(), &curl_easy_cleanup);
  if (!curl) return Fail(ErrorCode::kInternal, "libcurl does not start", "See whether memory is left.");
  const Headers headers = HeadersWith(token);
  std::string page;
  const std::string url = address + path;
  curl_easy_setopt(curl.get(), CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_NOPROXY, "*");
  curl_easy_setopt(curl.get(), CURLOPT_TIMEOUT_MS, kPageMax_ms);
  curl_easy_setopt(curl.get(), CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(curl.get(), CURLOPT_WRITEFUNCTION, &AppendTo);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEDATA, &page);
  const CURLcode done = curl_easy_perform(curl.get());
  if (done != CURLE_OK)
    return Fail(ErrorCode::kUnreachable, url + ": " + curl_easy_strerror(done),
                "If rigcald runs, give its address as --url.");
  long status = 0;
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &status);
  return "status " + std::to_string(status) + "\n" + page;
}

}  // namespace rigcal::client

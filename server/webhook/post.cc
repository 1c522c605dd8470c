#include "server/webhook/post.h"

#include <curl/curl.h>

#include <memory>
#include <mutex>

#include "server/base/digests/hmac.h"
#include "server/base/text.h"
#include "server/base/version.h"

namespace rigcal::webhook {
namespace {

constexpr std::size_t kSecretBytesMin = 16, kUrlBytesMax = 2048;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

using Curl = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;
struct Headers {
  curl_slist* list = nullptr;
  Headers() = default;
  Headers(const Headers&) = delete;
  Headers& operator=(const Headers&) = delete;
  ~Headers() { curl_slist_free_all(list); }
  void Add(const std::string& line) { list = curl_slist_append(list, line.c_str()); }
};

// What the receiver says beside its status is not looked at.
std::size_t Discard(char*, std::size_t size, std::size_t count, void*) { return size * count; }

int IsStopping(void* stopping, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const std::atomic<bool>*>(stopping)->load() ? 1 : 0;
}

Curl MakeCurl() {
  static std::once_flag once;
  std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
  return {curl_easy_init(), &curl_easy_cleanup};
}

Error Unreached(const std::string& why) {
  return {ErrorCode::kUnreachable, "no answer: " + why,
          "Look whether the receiver runs, and whether this machine reaches it."};
}

void AddHeaders(const Receiver& receiver, const Alert& alert, Stamp now, Headers& headers) {
  const std::int64_t timestamp_s = now.ns / kSecond_ns;
  headers.Add("Content-Type: application/json");
  headers.Add("Expect:");
  headers.Add("X-Rigcal-Id: " + alert.id.str());
  headers.Add("X-Rigcal-Timestamp: " + std::to_string(timestamp_s));
  headers.Add("X-Rigcal-Signature: " + SignatureOf(receiver.secret, timestamp_s, alert.body));
}

void SetUp(CURL* curl, const Receiver& receiver, const Alert& alert, const Headers& headers,
           const std::atomic<bool>& stopping) {
  const std::string agent = "rigcald/" + std::string(Version());
  curl_easy_setopt(curl, CURLOPT_URL, receiver.url.c_str());
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 0L);
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, kConnectMax_ms);
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, kPostMax_ms);
  curl_easy_setopt(curl, CURLOPT_USERAGENT, agent.c_str());
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers.list);
  curl_easy_setopt(curl, CURLOPT_POST, 1L);
  curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(alert.body.size()));
  curl_easy_setopt(curl, CURLOPT_POSTFIELDS, alert.body.data());
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &Discard);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, &IsStopping);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, const_cast<std::atomic<bool>*>(&stopping));
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
}

// As libcurl will read it when something is to be sent.
struct AddressRead {
  bool is_whole = false;  // it has a host, and a port that there can be
  bool has_user = false;
};
AddressRead ReadAddress(const std::string& url) {
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parsed(curl_url(), &curl_url_cleanup);
  if (!parsed || curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK) return {};
  char* user = nullptr;
  const bool has_user = curl_url_get(parsed.get(), CURLUPART_USER, &user, 0) == CURLUE_OK;
  curl_free(user);
  return {true, has_user};
}

}  // namespace

Status CheckReceiver(const Receiver& receiver) {
  const std::string& url = receiver.url;
  const bool is_http = url.rfind("http://", 0) == 0 || url.rfind("https://", 0) == 0;
  const bool has_space = url.find_first_of(" \t\r\n") != std::string::npos;
  const AddressRead read = ReadAddress(url);
  if (!is_http || has_space || url.size() > kUrlBytesMax || !IsPrintableUtf8(url) || !read.is_whole)
    return Fail(ErrorCode::kInvalidInput, "--webhook " + Quoted(url) + " is no address of HTTP",
                "Write, for instance, https://alerts.example.org/rigcal.");
  if (read.has_user)
    return Fail(ErrorCode::kInvalidInput, "a --webhook address names a user",
                "Leave the user out: the receiver knows the sender by the signature.");
  if (receiver.secret.size() < kSecretBytesMin)
    return Fail(ErrorCode::kInvalidInput, "the secret for --webhook " + url + " is shorter than 16 bytes",
                "Make one, for instance with `openssl rand -hex 32`, and give both sides the same.");
  return {};
}

std::string SignatureOf(const std::string& secret, std::int64_t timestamp_s, const std::string& body) {
  return "sha256=" + HmacSha256(secret, std::to_string(timestamp_s) + "." + body).str();
}

Result<int> Post(const Receiver& receiver, const Alert& alert, Stamp now, const std::atomic<bool>& stopping) {
  const Curl curl = MakeCurl();
  if (!curl) return Fail(Unreached("libcurl cannot be used"));
  Headers headers;
  AddHeaders(receiver, alert, now, headers);
  SetUp(curl.get(), receiver, alert, headers, stopping);
  const CURLcode done = curl_easy_perform(curl.get());
  if (done != CURLE_OK) return Fail(Unreached(curl_easy_strerror(done)));
  long status = 0;
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &status);
  return static_cast<int>(status);
}

}  // namespace rigcal::webhook

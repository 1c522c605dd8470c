#include "storage/s3/s3_link.h"

#include <curl/curl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <system_error>

#include "server/base/digests/sha256.h"
#include "server/base/files/file_descriptor.h"
#include "server/base/version.h"

namespace rigcal::storage {
namespace {

constexpr long kS3ConnectMax_ms = 5'000, kStallMax_s = 10, kStallBytesPerS = 1'000;
constexpr std::int64_t kWholeMax_ms = 60'000, kSlowestBytesPerMs = 16;
constexpr std::size_t kWrongBodyBytesMax = 64 << 10;
constexpr long kS3Ok = 200;

struct S3Headers {
  curl_slist* list = nullptr;
  S3Headers() = default;
  S3Headers(const S3Headers&) = delete;
  S3Headers& operator=(const S3Headers&) = delete;
  ~S3Headers() { curl_slist_free_all(list); }
  void Add(const std::string& line) { list = curl_slist_append(list, line.c_str()); }
};

// What is put, from where it was read to last.
struct Upload {
  std::string_view bytes;
  std::string name;  // of the file
  FileDescriptor file{-1};
  std::int64_t size = 0, at = 0;
  std::string why_not;
};

Upload OpenUpload(const S3Request& request) {
  Upload upload;
  upload.bytes = request.bytes;
  upload.size = static_cast<std::int64_t>(request.bytes.size());
  if (request.file.empty()) return upload;
  auto file = OpenToRead(request.file);
  if (!file) {
    upload.why_not = file.error().what;
    return upload;
  }
  upload.file = std::move(*file);
  upload.name = request.file.string();
  upload.size = lseek(upload.file.get(), 0, SEEK_END);
  if (upload.size < 0) upload.why_not = request.file.string() + " cannot be read";
  return upload;
}

// Nothing may be thrown through the library. Short, so that it needs no memory.
constexpr const char* kNoMemory = "no memory";

std::size_t GiveBytes(char* into, std::size_t size, std::size_t count, void* from) {
  Upload& upload = *static_cast<Upload*>(from);
  const std::size_t wanted = std::min(size * count, static_cast<std::size_t>(upload.size - upload.at));
  if (upload.file.get() < 0) {
    std::memcpy(into, upload.bytes.data() + upload.at, wanted);
  } else if (const ssize_t got = pread(upload.file.get(), into, wanted, upload.at);
             got != static_cast<ssize_t>(wanted)) {
    try {
      upload.why_not = upload.name + (got < 0 ? " cannot be read: " + std::generic_category().message(errno)
                                              : " became shorter while it was read");
    } catch (const std::exception&) {
      upload.why_not = kNoMemory;
    }
    return CURL_READFUNC_ABORT;
  }
  upload.at += static_cast<std::int64_t>(wanted);
  return wanted;
}

int GiveFrom(void* from, curl_off_t offset, int origin) {
  if (origin != SEEK_SET) return CURL_SEEKFUNC_CANTSEEK;
  static_cast<Upload*>(from)->at = offset;
  return CURL_SEEKFUNC_OK;
}

struct Download {
  const S3Request& request;
  CURL* curl;
  std::string& body;
  std::int64_t taken = 0;
  std::string why_not = {};
};

Status Take(Download& download, std::string_view bytes) {
  long status = 0;
  curl_easy_getinfo(download.curl, CURLINFO_RESPONSE_CODE, &status);
  if (download.request.kind != S3Request::Kind::kGet || status != kS3Ok) {
    download.body.append(bytes.substr(0, kWrongBodyBytesMax - download.body.size()));
    return {};
  }
  const std::size_t room = download.request.bytes_max - static_cast<std::size_t>(download.taken);
  if (bytes.size() > room)
    return Fail(ErrorCode::kStorage, "it is larger than " + std::to_string(download.request.bytes_max) + " bytes", "");
  if (download.request.take)
    RIGCAL_TRY(download.request.take(download.taken, bytes));
  else
    download.body.append(bytes);
  download.taken += static_cast<std::int64_t>(bytes.size());
  return {};
}

std::size_t TakeBytes(char* bytes, std::size_t size, std::size_t count, void* into) {
  auto& download = *static_cast<Download*>(into);
  try {
    const Status taken = Take(download, {bytes, size * count});
    if (taken) return size * count;
    download.why_not = taken.error().what;
  } catch (const std::exception&) {
    download.why_not = kNoMemory;
  }
  return 0;
}

std::string HashTold(const S3Request& request) {
  return request.kind == S3Request::Kind::kPut ? request.digest.str() : Sha256Of(std::string_view()).str();
}

void SetKind(CURL* curl, const S3Request& request, Upload& upload) {
  if (request.kind == S3Request::Kind::kHead) curl_easy_setopt(curl, CURLOPT_NOBODY, 1L);
  if (request.kind != S3Request::Kind::kPut) return;
  curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
  curl_easy_setopt(curl, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(upload.size));
  curl_easy_setopt(curl, CURLOPT_READFUNCTION, &GiveBytes);
  curl_easy_setopt(curl, CURLOPT_READDATA, &upload);
  curl_easy_setopt(curl, CURLOPT_SEEKFUNCTION, &GiveFrom);
  curl_easy_setopt(curl, CURLOPT_SEEKDATA, &upload);
}

void SetAddress(CURL* curl, const BucketPlace& place, const S3Request& request) {
  const std::string url = place.endpoint + "/" + place.bucket + "/" + request.object;
  const std::string agent = "rigcald/" + std::string(Version());
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 0L);
  curl_easy_setopt(curl, CURLOPT_USERAGENT, agent.c_str());
}

void SetPatience(CURL* curl, std::int64_t bytes) {
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, static_cast<long>(kWholeMax_ms + bytes / kSlowestBytesPerMs));
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, kS3ConnectMax_ms);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, kStallBytesPerS);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, kStallMax_s);
}

void SetKeys(CURL* curl, const BucketPlace& place, const BucketKeys& keys) {
  curl_easy_setopt(curl, CURLOPT_AWS_SIGV4, ("aws:amz:" + place.region + ":s3").c_str());
  curl_easy_setopt(curl, CURLOPT_USERNAME, keys.id.c_str());
  curl_easy_setopt(curl, CURLOPT_PASSWORD, keys.secret.c_str());
}

std::string WhyNot(CURLcode done) {
  const std::string why = curl_easy_strerror(done);
  const bool is_tls = done == CURLE_PEER_FAILED_VERIFICATION || done == CURLE_SSL_CONNECT_ERROR;
  return is_tls ? why + " (is its authority installed in this machine's CA certificates, and the clock right?)" : why;
}

void MakeReady() {
  static std::once_flag once;
  std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
}

}  // namespace

// A handle for one request.
class S3Link::Turn {
 public:
  explicit Turn(const S3Link& link) : link_(link) {
    MakeReady();
    const std::lock_guard lock(link_.mutex_);
    curl_ = link_.idle_.empty() ? curl_easy_init() : link_.idle_.back();
    if (!link_.idle_.empty()) link_.idle_.pop_back();
  }
  ~Turn() {
    if (curl_ == nullptr) return;
    if (std::uncaught_exceptions() > thrown_ || !GiveBack()) curl_easy_cleanup(curl_);
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  [[nodiscard]] CURL* curl() const { return curl_; }

 private:
  [[nodiscard]] bool GiveBack() noexcept {
    try {
      curl_easy_reset(curl_);
      const std::lock_guard lock(link_.mutex_);
      link_.idle_.push_back(curl_);
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }

  const S3Link& link_;
  const int thrown_ = std::uncaught_exceptions();
  CURL* curl_ = nullptr;
};

S3Link::~S3Link() {
  for (void* const one : idle_) curl_easy_cleanup(one);
}

S3Answer S3Link::Ask(const S3Request& request) const {
  const Turn turn(*this);
  if (turn.curl() == nullptr) return {0, "", "libcurl cannot be used", true};
  S3Answer answer;
  Upload upload = OpenUpload(request);
  if (!upload.why_not.empty()) return {0, "", upload.why_not, true};
  Download download{request, turn.curl(), answer.body};
  S3Headers headers;
  headers.Add("x-amz-content-sha256: " + HashTold(request));
  if (!keys_.session_token.empty()) headers.Add("x-amz-security-token: " + keys_.session_token);
  SetAddress(turn.curl(), place_, request);
  SetPatience(turn.curl(), std::max(upload.size, static_cast<std::int64_t>(request.bytes_max)));
  SetKeys(turn.curl(), place_, keys_);
  SetKind(turn.curl(), request, upload);
  curl_easy_setopt(turn.curl(), CURLOPT_HTTPHEADER, headers.list);
  curl_easy_setopt(turn.curl(), CURLOPT_WRITEFUNCTION, &TakeBytes);
  curl_easy_setopt(turn.curl(), CURLOPT_WRITEDATA, &download);
  const CURLcode done = curl_easy_perform(turn.curl());
  for (const std::string& why : {upload.why_not, download.why_not})
    if (!why.empty()) return {0, "", why, true};
  if (done != CURLE_OK) return {0, "", WhyNot(done)};
  long status = 0;
  curl_easy_getinfo(turn.curl(), CURLINFO_RESPONSE_CODE, &status);
  answer.status = static_cast<int>(status);
  curl_off_t size_bytes = -1;
  if (request.kind == S3Request::Kind::kHead)
    curl_easy_getinfo(turn.curl(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &size_bytes);
  answer.size_bytes = size_bytes;
  return answer;
}

}  // namespace rigcal::storage

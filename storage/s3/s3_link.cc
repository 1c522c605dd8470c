#include "storage/s3/s3_link.h"

#include <curl/curl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "server/base/digests/sha256.h"
#include "server/base/files/file_descriptor.h"
#include "server/base/version.h"

namespace rigcal::storage {
namespace {

constexpr long kS3ConnectMax_ms = 5'000, kStallMax_s = 10, kStallBytesPerS = 1'000;
constexpr std::size_t kWrongBodyBytesMax = 64 << 10;

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
  upload.size = lseek(upload.file.get(), 0, SEEK_END);
  if (upload.size < 0) upload.why_not = request.file.string() + " cannot be read";
  return upload;
}

std::size_t GiveBytes(char* into, std::size_t size, std::size_t count, void* from) {
  Upload& upload = *static_cast<Upload*>(from);
  const std::size_t wanted = std::min(size * count, static_cast<std::size_t>(upload.size - upload.at));
  if (upload.file.get() < 0) {
    std::memcpy(into, upload.bytes.data() + upload.at, wanted);
  } else if (pread(upload.file.get(), into, wanted, upload.at) != static_cast<ssize_t>(wanted)) {
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
  std::string& body;
  std::size_t bytes_max;
};

std::size_t TakeBytes(char* bytes, std::size_t size, std::size_t count, void* into) {
  auto& download = *static_cast<Download*>(into);
  if (download.body.size() + size * count > download.bytes_max) return 0;
  download.body.append(bytes, size * count);
  return size * count;
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

void SetPatience(CURL* curl) {
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
    curl_easy_reset(curl_);
    const std::lock_guard lock(link_.mutex_);
    link_.idle_.push_back(curl_);
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  [[nodiscard]] CURL* curl() const { return curl_; }

 private:
  const S3Link& link_;
  CURL* curl_ = nullptr;
};

S3Link::~S3Link() {
  for (void* const one : idle_) curl_easy_cleanup(one);
}

S3Answer S3Link::Ask(const S3Request& request) const {
  const Turn turn(*this);
  if (turn.curl() == nullptr) return {0, "", "libcurl cannot be used"};
  S3Answer answer;
  Upload upload = OpenUpload(request);
  if (!upload.why_not.empty()) return {0, "", upload.why_not};
  Download download{answer.body, std::max(request.bytes_max, kWrongBodyBytesMax)};
  S3Headers headers;
  headers.Add("x-amz-content-sha256: " + HashTold(request));
  if (!keys_.session_token.empty()) headers.Add("x-amz-security-token: " + keys_.session_token);
  SetAddress(turn.curl(), place_, request);
  SetPatience(turn.curl());
  SetKeys(turn.curl(), place_, keys_);
  SetKind(turn.curl(), request, upload);
  curl_easy_setopt(turn.curl(), CURLOPT_HTTPHEADER, headers.list);
  curl_easy_setopt(turn.curl(), CURLOPT_WRITEFUNCTION, &TakeBytes);
  curl_easy_setopt(turn.curl(), CURLOPT_WRITEDATA, &download);
  const CURLcode done = curl_easy_perform(turn.curl());
  if (done != CURLE_OK) return {0, "", curl_easy_strerror(done)};
  long status = 0;
  curl_easy_getinfo(turn.curl(), CURLINFO_RESPONSE_CODE, &status);
  answer.status = static_cast<int>(status);
  return answer;
}

}  // namespace rigcal::storage

#include "storage/s3/bucket.h"

#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "server/base/digests/sha256.h"

namespace rigcal::storage {
namespace {

constexpr int kBucketTriesMax = 3;
constexpr std::chrono::milliseconds kFirstPause{200};
constexpr std::chrono::seconds kTriesWithin{8};  // no further one begins later
constexpr std::chrono::seconds kLeftAlone{5};
constexpr int kOk = 200, kMoved = 301, kMovedForNow = 307, kForbidden = 403, kNoObject = 404, kTooMany = 429;
constexpr std::size_t kOwnerBytesMax = 256;
const std::string kOwnerObject = "rigcal-store", kAbsentObject = "rigcal-absent";

bool IsAway(const S3Answer& answer) { return answer.status == 0 && !answer.is_ours; }
bool MayPass(const S3Answer& answer) { return IsAway(answer) || answer.status == kTooMany || answer.status >= 500; }

// "NoSuchKey", of the service's XML.
std::string CodeIn(const std::string& body) {
  constexpr std::string_view kBegin = "<Code>";
  constexpr std::size_t kCodeBytesMax = 64;
  const std::size_t begin = body.find(kBegin), from = begin + kBegin.size();
  const std::size_t end = begin == std::string::npos ? begin : body.find("</Code>", from);
  if (end == std::string::npos || end - from > kCodeBytesMax) return "";
  const std::string code = body.substr(from, end - from);
  return code.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.") == std::string::npos
             ? code
             : "";
}

// Any other 404 may be that of a proxy, or of what else answers at the address.
bool IsAbsent(const S3Answer& answer) { return answer.status == kNoObject && CodeIn(answer.body) == "NoSuchKey"; }

std::string SaidOf(const S3Answer& answer) {
  const std::string code = CodeIn(answer.body);
  return "HTTP status " + std::to_string(answer.status) + (code.empty() ? "" : ", " + code);
}

// By the code; "" stands for any other that goes with HTTP 403.
struct Refusal {
  std::string_view code;
  const char *what, *cure;
};
constexpr std::array kRefusals = {
    Refusal{"NoSuchBucket", " does not exist", "Make the bucket, or mend --blobs and AWS_ENDPOINT_URL_S3."},
    Refusal{"SignatureDoesNotMatch", " does not accept the key: the secret is wrong",
            "Mend AWS_SECRET_ACCESS_KEY, or the file of AWS_SHARED_CREDENTIALS_FILE."},
    Refusal{"InvalidAccessKeyId", " does not know the key", "Mend AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY."},
    Refusal{"RequestTimeTooSkewed", " has another time than this machine", "Set the clock of this machine."},
    Refusal{"ExpiredToken", " does not accept the key any more", "Give a new one and restart."},
    Refusal{"AuthorizationHeaderMalformed", " is in another region", "Set AWS_REGION to that of the bucket."},
    Refusal{"PermanentRedirect", " is in another region", "Set AWS_REGION to that of the bucket."},
    Refusal{"", " refuses access", "Allow the key s3:GetObject, s3:PutObject and s3:ListBucket there."}};

const Refusal* FindRefusal(const S3Answer& answer) {
  const std::string code = CodeIn(answer.body);
  for (const Refusal& one : kRefusals)
    if (!code.empty() && one.code == code) return &one;
  if (answer.status == kMoved || answer.status == kMovedForNow) return &kRefusals[kRefusals.size() - 2];
  return answer.status == kForbidden ? &kRefusals.back() : nullptr;
}

// A person may mend it while the server goes on.
Error ForNow(Error error) {
  if (error.code == ErrorCode::kInvalidInput) error.code = ErrorCode::kUnreachable;
  return error;
}

}  // namespace

struct Bucket::Seen {
  std::mutex mutex;
  std::chrono::steady_clock::time_point alone_until;
  std::string why;
  std::atomic<bool> has_put{false};

  [[nodiscard]] std::optional<S3Answer> StillAway() {
    const std::lock_guard lock(mutex);
    return std::chrono::steady_clock::now() < alone_until ? std::optional(S3Answer{0, "", why}) : std::nullopt;
  }
  void Note(const S3Answer& answer) {
    const std::lock_guard lock(mutex);
    alone_until =
        IsAway(answer) ? std::chrono::steady_clock::now() + kLeftAlone : std::chrono::steady_clock::time_point();
    why = answer.why;
  }
};

Bucket::Seen& Bucket::SeenOf(const BucketPlace& place) {
  static std::mutex mutex;
  static std::map<std::string, Seen> all;
  const std::lock_guard lock(mutex);
  return all[place.endpoint + "/" + place.bucket + "/" + place.prefix];
}

Bucket::Bucket(BucketPlace place, BucketKeys keys)
    : link_(std::move(place), std::move(keys)), seen_(SeenOf(link_.place())) {}

Result<std::shared_ptr<const Bucket>> Bucket::Open(const std::string& place) {
  RIGCAL_ASSIGN(BucketPlace read, ReadBucketPlace(place));
  RIGCAL_ASSIGN(BucketKeys keys, FindBucketKeys());
  return std::shared_ptr<const Bucket>(new Bucket(std::move(read), std::move(keys)));
}

std::string Bucket::ObjectOf(const std::string& name) const {
  const std::string& prefix = link_.place().prefix;
  return prefix.empty() ? name : prefix + "/" + name;
}

std::string Bucket::ObjectOf(const Digest& digest) const {
  return ObjectOf(digest.str().substr(0, 2) + "/" + digest.str());
}

S3Answer Bucket::Ask(const S3Request& request) const {
  if (auto away = seen_.StillAway()) return *std::move(away);
  const auto began = std::chrono::steady_clock::now();
  auto pause = kFirstPause;
  for (int i = 1;; ++i, pause *= 4) {
    S3Answer answer = link_.Ask(request);
    const bool is_late = std::chrono::steady_clock::now() - began > kTriesWithin;
    if (!MayPass(answer) || i == kBucketTriesMax || is_late) {
      seen_.Note(answer);
      return answer;
    }
    std::this_thread::sleep_for(pause);
  }
}

// kInvalidInput where a person has to do something about it; kStorage where it is this request that it does not take.
Error Bucket::ErrorOf(const S3Answer& answer) const {
  constexpr const char* kGoesOn =
      "Look whether it runs and this machine reaches it; what waits goes on by itself then.";
  if (const Refusal* refusal = FindRefusal(answer))
    return {ErrorCode::kInvalidInput, "the bucket " + name() + refusal->what + " (" + SaidOf(answer) + ")",
            refusal->cure};
  if (answer.is_ours)
    return {ErrorCode::kStorage, "a file was not exchanged with the bucket " + name() + ": " + answer.why,
            "Check the disk of this machine, and the file."};
  if (answer.status == 0)
    return {ErrorCode::kUnreachable, "the bucket " + name() + " cannot be reached: " + answer.why, kGoesOn};
  if (MayPass(answer) || answer.status == kNoObject)
    return {ErrorCode::kUnreachable, "the bucket " + name() + " does not work: it answers " + SaidOf(answer), kGoesOn};
  return {ErrorCode::kStorage, "the bucket " + name() + " did not take a file: it answers " + SaidOf(answer),
          "Check the disk of this machine; or report it with the server's log."};
}

Status Bucket::PutObject(const S3Request& request) const {
  const S3Answer answer = Ask(request);
  seen_.has_put = answer.status == kOk;
  return answer.status == kOk ? Status() : Status(Fail(ErrorOf(answer)));
}

Result<std::optional<std::string>> Bucket::GetObject(const std::string& object, std::size_t bytes_max) const {
  S3Answer answer = Ask({.kind = S3Request::Kind::kGet, .object = object, .bytes_max = bytes_max});
  if (answer.status == kOk) return std::optional(std::move(answer.body));
  if (IsAbsent(answer)) return std::optional<std::string>();
  return Fail(ErrorOf(answer));
}

// It is there, or is not.
Result<S3Answer> Bucket::AskFor(const Digest& digest) const {
  S3Answer answer = Ask({.kind = S3Request::Kind::kHead, .object = ObjectOf(digest)});
  if (answer.status == kOk || answer.status == kNoObject) return answer;  // HEAD has no body with a code
  return Fail(ForNow(ErrorOf(answer)));
}

Result<bool> Bucket::Has(const Digest& digest) const {
  return AskFor(digest).map([](const S3Answer& answer) { return answer.status == kOk; });
}

Result<bool> Bucket::Has(const Digest& digest, std::int64_t size_bytes) const {
  return AskFor(digest).map([&](const S3Answer& answer) {
    return answer.status == kOk && (answer.size_bytes < 0 || answer.size_bytes == size_bytes);
  });
}

Status Bucket::Put(const Digest& digest, const std::filesystem::path& file) const {
  return PutObject({.kind = S3Request::Kind::kPut, .object = ObjectOf(digest), .digest = digest, .file = file})
      .map_error(ForNow);
}

Status Bucket::Put(const Digest& digest, std::string_view bytes) const {
  return PutObject({.kind = S3Request::Kind::kPut, .object = ObjectOf(digest), .digest = digest, .bytes = bytes})
      .map_error(ForNow);
}

Result<bool> Bucket::Get(const Digest& digest, std::size_t bytes_max, const TakeContent& take) const {
  const S3Answer answer =
      Ask({.kind = S3Request::Kind::kGet, .object = ObjectOf(digest), .bytes_max = bytes_max, .take = take});
  if (answer.status == kOk || IsAbsent(answer)) return answer.status == kOk;
  return Fail(ForNow(ErrorOf(answer)));
}

Result<std::string> Bucket::LoadOwner() const {
  RIGCAL_ASSIGN(auto owner, GetObject(ObjectOf(kOwnerObject), kOwnerBytesMax));
  return owner.value_or("");
}

Status Bucket::PutOwner(const std::string& store_id) const {
  return PutObject({.kind = S3Request::Kind::kPut,
                    .object = ObjectOf(kOwnerObject),
                    .digest = Sha256Of(store_id),
                    .bytes = store_id});
}

Status Bucket::CheckOwner(const std::string& store_id) const {
  RIGCAL_ASSIGN(const std::string owner, LoadOwner());
  if (owner != store_id)
    return Fail(ErrorCode::kConflict,
                "the bucket " + name() + (owner.empty() ? " has nothing of this store" : " is that of another store"),
                "Give the bucket and AWS_ENDPOINT_URL_S3 that the store was begun with.");
  return {};
}

Status Bucket::Check(const std::string& store_id) const {
  RIGCAL_TRY(CheckOwner(store_id));
  if (!seen_.has_put) RIGCAL_TRY(PutOwner(store_id));
  RIGCAL_TRY(GetObject(ObjectOf(kAbsentObject), kOwnerBytesMax));
  return {};
}

}  // namespace rigcal::storage

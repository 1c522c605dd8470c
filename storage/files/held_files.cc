#include "storage/files/held_files.h"

#include <chrono>
#include <optional>
#include <system_error>

#include "server/base/log.h"
#include "storage/database/query.h"
#include "storage/files/blobs.h"
#include "storage/files/lost_blobs.h"
#include "storage/s3/bucket.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kBucketAskedFor{2};

// Looks at lengths, in the folder first.
class Lengths {
 public:
  explicit Lengths(const Blobs& blobs) : blobs_(blobs), asks_(blobs.bucket() != nullptr) {}

  // Nothing: it cannot be told now.
  [[nodiscard]] std::optional<bool> IsRight(const HeldFile& file) {
    std::error_code failed;
    const auto bytes = fs::file_size(BlobPath(blobs_.folder(), file.digest), failed);
    if (!failed) return static_cast<std::int64_t>(bytes) == file.size_bytes;
    if (blobs_.bucket() == nullptr || failed != std::errc::no_such_file_or_directory) return false;
    return asks_ ? IsRightInBucket(file) : std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<bool> IsRightInBucket(const HeldFile& file) {
    const Result<bool> is_there = blobs_.bucket()->Has(file.digest, file.size_bytes);
    asks_ = is_there && std::chrono::steady_clock::now() - began_ < kBucketAskedFor;
    return is_there ? std::optional(*is_there) : std::nullopt;
  }

  const Blobs& blobs_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  bool asks_;
};

struct Lost {
  Digest digest;
  BlobState state = BlobState::kMissing;
};

// A length that is not right need not mean a loss: the bytes decide.
Result<HeldState> LookCloser(const Blobs& blobs, const Digest& digest, std::vector<Lost>& lost) {
  const Result<BlobState> state = SetDamagedAside(blobs, digest);
  if (!state && state.error().code == ErrorCode::kUnreachable) return HeldState::kUnknown;
  if (!state) return Fail(state.error());
  if (*state == BlobState::kGood) return HeldState::kKept;
  lost.push_back({digest, *state});
  return HeldState::kLost;
}

Status NoteLost(Store& store, const std::vector<Lost>& lost, Stamp now) {
  if (lost.empty()) return {};
  RIGCAL_TRY(store.Write([&]() -> Status {
    for (const Lost& one : lost) RIGCAL_TRY(AppendLost(store, one.digest, one.state, std::nullopt, now));
    return {};
  }));
  const Lost& first = lost.front();
  LogWarn(std::to_string(lost.size()) + " files that a robot pushed are not in the store as they came (the first, " +
          BlobPath(store.BlobFolder(), first.digest).string() +
          (first.state == BlobState::kMissing ? ", is missing" : ", is damaged") +
          "): they are asked for again. Check the disk.");
  return {};
}

}  // namespace

Result<std::vector<HeldState>> CheckHeld(Store& store, const std::vector<HeldFile>& files, Stamp now) {
  Lengths lengths(store.blobs());
  std::vector<HeldState> states;
  std::vector<Lost> lost;
  for (const HeldFile& file : files) {
    const std::optional<bool> is_right = lengths.IsRight(file);
    states.push_back(is_right ? HeldState::kKept : HeldState::kUnknown);
    if (is_right.value_or(true)) continue;
    RIGCAL_ASSIGN(states.back(), LookCloser(store.blobs(), file.digest, lost));
  }
  RIGCAL_TRY(NoteLost(store, lost, now));
  return states;
}

Status NoteLostFiles(Store& store, const SessionId& session, Stamp now) {
  std::vector<HeldFile> files;
  RIGCAL_TRY(store.connection().Load("payloads of session " + session.str(), [&]() -> Status {
    Query query(
        store,
        "SELECT DISTINCT p.digest, p.size_bytes FROM session s CROSS JOIN payload_held h ON h.session_number = "
        "s.number "
        "CROSS JOIN payload p ON p.session_number = h.session_number AND p.idx = h.idx WHERE s.session_id = ? AND NOT "
        "EXISTS (SELECT 1 FROM waiting_blob w WHERE w.digest = p.digest) ORDER BY p.digest");
    query.Bind(session);
    while (query.Step()) files.push_back({query.IdAt<Digest>(0), query.Int(1)});
    return {};
  }));
  return CheckHeld(store, files, now).map([](const auto&) {});
}

}  // namespace rigcal::storage

// Contents that a receipt was given for and that the disk has not kept. They count as not held (LoadHeld, SessionRow)
// until AppendHeld says that they are there again; then what failed for want of them is queued again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/sessions/session.h"
#include "storage/files/blobs.h"
#include "storage/store.h"

namespace rigcal::storage {

// `state` is kDamaged or kMissing. `job_number`: whose edge failed for want of it. A no-op for what is known.
[[nodiscard]] Status AppendLost(Store& store, const Digest& digest, BlobState state,
                                std::optional<std::int64_t> job_number, Stamp now);

// The same, found before a store is open. For storage/*.cc only, inside of an Append.
void NoteLost(Connection& connection, const Digest& digest, BlobState state, Stamp now);

// Every payload of a session that is lost and was not sent again, by robot, session and path.
struct LostPayload {
  RobotId robot;
  SessionId session;
  std::string path;
  BlobState state = BlobState::kDamaged;
};
struct LostPayloads {
  std::int64_t count = 0;
  std::vector<LostPayload> first;
};
// By robot, session and path. `count`: of all of them, `first`: up to `first_max`.
[[nodiscard]] Result<LostPayloads> LoadLost(Store& store, std::size_t first_max);

// The content of this payload is on disk again: it is lost no more, jobs that waited for nothing else are queued again,
// what was not sent on to a centre for want of it is tried again;
// where none waited, the newest revisions of the robots that sent it are published again. For storage/*.cc, inside of
// an Append.
[[nodiscard]] Status EndLoss(Store& store, std::int64_t session_number, std::uint32_t payload_idx);

}  // namespace rigcal::storage

// Files that rows call held, held against the disk before a receipt names them: by their lengths alone. To read a large
// session takes seconds, in which no other robot would have a receipt; `rigcal fsck` reads.
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/stamp.h"
#include "storage/store.h"

namespace rigcal::storage {

struct HeldFile {
  Digest digest;
  std::int64_t size_bytes = 0;  // of its manifest
};
enum class HeldState : std::uint8_t {
  kKept,
  kLost,
  kUnknown,  // the bucket that has it cannot be asked now, or has not said it in two seconds for all of them
};
// One per file. One that is gone, or has another length, is read: what is not as it was pushed is set aside and counts
// as lost from now on (lost_blobs.h), so that it is asked for again; the log tells of it. The error is of a disk that
// cannot be asked: nothing follows for the file.
[[nodiscard]] Result<std::vector<HeldState>> CheckHeld(Store& store, const std::vector<HeldFile>& files, Stamp now);

// The same of all that a session holds: what is lost of it is not held any more (LoadHeld, SessionRow). A no-op if the
// session is not known.
[[nodiscard]] Status NoteLostFiles(Store& store, const SessionId& session, Stamp now);

}  // namespace rigcal::storage

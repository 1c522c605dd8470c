// READ: bytes of payloads, held against their hashes. What the disk has not kept is named, and asked for again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/limits.h"
#include "server/model/diagnosis.h"
#include "server/model/sessions/session.h"
#include "storage/files/lost_blobs.h"

namespace rigcal::pipeline {

// The bytes that were pushed. kStorage where the disk has not kept them: nothing may be concluded of the payload, and
// FindLost tells more; kUnreachable where they are not to be had now. Any thread.
[[nodiscard]] Result<std::string> LoadPayload(const storage::Blobs& blobs, const Payload& payload,
                                              std::size_t bytes_max = limits::kPayloadBytesMax);

struct LostFile {
  const Payload* payload = nullptr;
  storage::BlobState state = storage::BlobState::kDamaged;
};
// Reads them all; what is damaged is set aside. The payloads outlive the answer.
[[nodiscard]] Result<std::vector<LostFile>> FindLost(const storage::Store& store,
                                                     const std::vector<const Payload*>& payloads);
// From now on a push of a session with these files is asked for them. `job_number`: is run again then.
[[nodiscard]] Status AppendLost(storage::Store& store, const std::vector<LostFile>& lost,
                                std::optional<std::int64_t> job_number, Stamp now);
// Names robot, sensors and files, and what to do.
[[nodiscard]] Diagnosis TellLost(const RobotId& robot, const std::vector<LostFile>& lost);

}  // namespace rigcal::pipeline

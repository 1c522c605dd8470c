// What arrived over DDS, checked as it is taken, on its way from threads D and Q to thread W.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "idl/convert.h"
#include "idl/dds.h"
#include "server/base/ids.h"
#include "server/model/approval/order_origin.h"
#include "server/model/robots/robot_runs.h"

namespace rigcal::dds {

struct OpenSession {
  RobotId robot;
  SessionId session;
  std::uint32_t protocol = 0;
};

struct ManifestText {
  RobotId robot;
  SessionId session;
  std::string bytes;
  std::vector<SessionId> superseded_by = {};  // at the site that sends it on (storage/sites/superseded_there.h)
};

struct ChunkBytes {
  RobotId robot;
  SessionId session;
  std::uint32_t payload_idx = 0;
  std::uint64_t offset_bytes = 0;
  std::string bytes;
};

// A chunk that was thrown away because the intake is full: the client is told to send it again.
struct DiscardedChunk {
  RobotId robot;
  SessionId session;
  std::uint32_t payload_idx = 0;
  std::uint64_t offset_bytes = 0;
};

// A sample that is refused. Answered in the partition of its writer, which need not be that of the robot it names.
struct Refusal {
  RobotId partition;
  RobotId robot;
  std::string subject_id;
  Error error;
};

// What a person asks to be changed. `answer` takes the document once the change is on disk, or the error.
struct Order {
  std::string verb, json;
  std::function<void(Result<std::string>)> answer;
  std::string request = {};  // the question's id, for the log
  OrderOrigin origin = {};
};

using Arrival =
    std::variant<OpenSession, ManifestText, ChunkBytes, DiscardedChunk, wire::BatchItem, Refusal, Order, RunsReport>;

// Memory it holds while it waits.
[[nodiscard]] std::int64_t BytesOf(const Arrival& arrival);

// A sample of DDS, checked: the value; or a Refusal; or nothing, where nobody can be answered (the writer is gone, the
// subject has no valid id). Pure. The robot a sample speaks for is the partition of its writer, as discovery tells it;
// a sample that names another robot is refused. For what robots send: SessionHeader, Manifest, Chunk, PairwiseResult,
// CalibrationInUse (idl/rigcal.idl).
template <typename Sample>
[[nodiscard]] std::optional<Arrival> FromIdl(const Sample& sample, const wire::SampleOrigin& origin);

// The robot of a "robot/<id>" partition; nullopt for any other.
[[nodiscard]] std::optional<RobotId> RobotOfPartition(const std::string& partition);

}  // namespace rigcal::dds

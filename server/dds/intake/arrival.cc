#include "server/dds/intake/arrival.h"

#include <algorithm>
#include <string_view>

#include "server/base/limits.h"
#include "server/base/text.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kItemBytes = 512;  // ids and queue overhead of a small arrival

std::size_t ContentBytes(const wire::BatchItem& item) {
  const Uncertainty& uncertainty = item.edge.uncertainty;
  return sizeof(wire::BatchItem) + uncertainty.blocks.size() * (sizeof(BlockVector) + limits::kNameMax) +
         uncertainty.contributions.size() * (sizeof(Contribution) + limits::kNameMax);
}

std::size_t ContentBytes(const ChunkBytes& chunk) { return chunk.bytes.size(); }
std::size_t ContentBytes(const ManifestText& text) { return text.bytes.size(); }
std::size_t ContentBytes(const Order& order) { return order.json.size(); }
template <typename T>
std::size_t ContentBytes(const T&) {
  return 0;
}

constexpr std::string_view kRobotPrefix = "robot/";

Status CheckSpeaker(const RobotId& robot, const wire::SampleOrigin& origin) {
  const auto& own = origin.partitions;
  if (std::find(own.begin(), own.end(), wire::RobotPartition(robot)) != own.end()) return {};
  const std::string speaker = own.empty() ? "nobody" : Quoted(own.front());
  return Fail(ErrorCode::kInvalidInput, "robot " + robot.str() + ": its data came from partition " + speaker,
              "Write a robot's data in its own partition " + wire::RobotPartition(robot));
}

std::string_view TextOf(const dds_sequence_octet& bytes) {
  return {reinterpret_cast<const char*>(bytes._buffer), bytes._length};
}

// Whom to tell, if there is somebody: the first robot in whose partition the writer is.
std::optional<Arrival> Refuse(const char* robot_id, const char* subject_id, const wire::SampleOrigin& origin,
                              const Error& error) {
  const auto robot = RobotId::Parse(robot_id);
  if (!robot || !CheckDigest("subject", subject_id)) return std::nullopt;
  for (const std::string& partition : origin.partitions)
    if (const auto speaker = RobotOfPartition(partition)) return Refusal{*speaker, *robot, subject_id, error};
  return std::nullopt;
}

struct Subject {
  RobotId robot;
  SessionId session;
};

Result<Subject> SubjectOf(const char* robot_id, const char* session_id, const wire::SampleOrigin& origin) {
  Subject subject;
  RIGCAL_ASSIGN(subject.robot, RobotId::Parse(robot_id));
  RIGCAL_ASSIGN(subject.session, SessionId::Parse(session_id));
  RIGCAL_TRY(CheckSpeaker(subject.robot, origin));
  return subject;
}

Status CheckSize(const char* what, std::uint64_t size_bytes, std::uint64_t bytes_max) {
  if (size_bytes > 0 && size_bytes <= bytes_max) return {};
  return Fail(ErrorCode::kInvalidInput, std::string(what) + " of " + std::to_string(size_bytes) + " bytes",
              "Send 1 to " + std::to_string(bytes_max) + " bytes");
}

Result<Arrival> Checked(const rigcal_wire_SessionHeader& sample, const wire::SampleOrigin& origin) {
  RIGCAL_ASSIGN(Subject subject, SubjectOf(sample.robot_id, sample.session_id, origin));
  return OpenSession{std::move(subject.robot), std::move(subject.session), sample.protocol};
}

Result<Arrival> Checked(const rigcal_wire_Manifest& sample, const wire::SampleOrigin& origin) {
  RIGCAL_ASSIGN(Subject subject, SubjectOf(sample.robot_id, sample.session_id, origin));
  RIGCAL_TRY(CheckSize("manifest", sample.bytes._length, limits::kManifestBytesMax));
  return ManifestText{std::move(subject.robot), std::move(subject.session), std::string(TextOf(sample.bytes))};
}

Result<Arrival> Checked(const rigcal_wire_Chunk& sample, const wire::SampleOrigin& origin) {
  RIGCAL_ASSIGN(Subject subject, SubjectOf(sample.robot_id, sample.session_id, origin));
  RIGCAL_TRY(CheckSize("chunk", sample.bytes._length, limits::kChunkBytesMax));
  return ChunkBytes{std::move(subject.robot), std::move(subject.session), sample.payload_idx, sample.offset_bytes,
                    std::string(TextOf(sample.bytes))};
}

Result<Arrival> Checked(const rigcal_wire_PairwiseResult& sample, const wire::SampleOrigin& origin) {
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(sample.robot_id));
  RIGCAL_TRY(CheckSpeaker(robot, origin));
  RIGCAL_ASSIGN(wire::BatchItem item, wire::FromPairwiseResult(sample));
  return item;
}

Result<Arrival> Checked(const rigcal_wire_CalibrationInUse& sample, const wire::SampleOrigin& origin) {
  RunsReport report;
  RIGCAL_ASSIGN(report.robot, RobotId::Parse(sample.robot_id));
  RIGCAL_TRY(CheckSpeaker(report.robot, origin));
  RIGCAL_ASSIGN(report.digest, Digest::Parse(sample.digest));
  report.applied_at = {sample.applied_ns};
  report.who = sample.who;
  return report;
}

// What its writer is told about by.
template <typename Sample>
const char* SubjectIn(const Sample& sample) {
  return sample.session_id;
}
const char* SubjectIn(const rigcal_wire_PairwiseResult& sample) { return sample.batch_id; }
const char* SubjectIn(const rigcal_wire_CalibrationInUse& sample) { return sample.digest; }

}  // namespace

std::int64_t BytesOf(const Arrival& arrival) {
  return static_cast<std::int64_t>(kItemBytes + std::visit([](const auto& one) { return ContentBytes(one); }, arrival));
}

template <typename Sample>
std::optional<Arrival> FromIdl(const Sample& sample, const wire::SampleOrigin& origin) {
  Result<Arrival> checked = Checked(sample, origin);
  if (checked) return std::move(*checked);
  return Refuse(sample.robot_id, SubjectIn(sample), origin, checked.error());
}
template std::optional<Arrival> FromIdl(const rigcal_wire_SessionHeader&, const wire::SampleOrigin&);
template std::optional<Arrival> FromIdl(const rigcal_wire_Manifest&, const wire::SampleOrigin&);
template std::optional<Arrival> FromIdl(const rigcal_wire_Chunk&, const wire::SampleOrigin&);
template std::optional<Arrival> FromIdl(const rigcal_wire_PairwiseResult&, const wire::SampleOrigin&);
template std::optional<Arrival> FromIdl(const rigcal_wire_CalibrationInUse&, const wire::SampleOrigin&);

std::optional<RobotId> RobotOfPartition(const std::string& partition) {
  if (partition.compare(0, kRobotPrefix.size(), kRobotPrefix) != 0) return std::nullopt;
  const auto robot = RobotId::Parse(std::string_view(partition).substr(kRobotPrefix.size()));
  return robot ? std::optional(*robot) : std::nullopt;
}

}  // namespace rigcal::dds

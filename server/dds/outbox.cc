#include "server/dds/outbox.h"

#include "server/base/log.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kRobotsMax = 16'000;  // a participant may have 16,382 publishers
constexpr std::size_t kFinishedReceiptsMax = 4'096;

void LogFailure(const Status& status) {
  if (!status) LogError(status.error());
}

// The text must outlive the sample; DDS only reads it.
char* Borrow(const std::string& text) { return const_cast<char*>(text.c_str()); }

template <std::size_t N>
Status Put(const std::string& text, char (&to)[N], const char* field) {
  return wire::CopyText(text, to, N, field);
}

Status FillEvent(const Announcement& announcement, rigcal_wire_Event& sample) {
  RIGCAL_TRY(Put(announcement.robot.str(), sample.robot_id, "robot_id"));
  RIGCAL_TRY(Put(announcement.kind, sample.kind, "event kind"));
  RIGCAL_TRY(Put(announcement.subject_id, sample.subject_id, "event subject"));
  sample.stamp_ns = announcement.at.ns;
  sample.json = Borrow(announcement.json);
  return {};
}

void FillPose(const SensorPose& pose, rigcal_wire_Calibration& sample) {
  const Se3 T_ref_sensor = pose.known ? pose.T_ref_sensor : Se3{};
  sample.known = pose.known;
  for (int i = 0; i < 3; ++i) sample.p_m[i] = T_ref_sensor.p_m[i];
  for (int i = 0; i < 4; ++i) sample.q_xyzw[i] = T_ref_sensor.q.coeffs()[i];
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 6; ++col) sample.covariance[6 * row + col] = pose.known ? pose.covariance(row, col) : 0.0;
}

}  // namespace

Result<std::shared_ptr<Outbox::RobotWriters>> Outbox::OpenWriters(const RobotId& robot) const {
  RIGCAL_ASSIGN(auto publisher, wire::Publisher::Open(participant_, wire::RobotPartition(robot)));
  RIGCAL_ASSIGN(auto receipts, wire::Writer<rigcal_wire_Receipt>::Open(participant_, publisher));
  RIGCAL_ASSIGN(auto events, wire::Writer<rigcal_wire_Event>::Open(participant_, publisher));
  RIGCAL_ASSIGN(auto calibrations, wire::Writer<rigcal_wire_Calibration>::Open(participant_, publisher));
  RIGCAL_ASSIGN(auto statuses, wire::Writer<rigcal_wire_RobotStatus>::Open(participant_, publisher));
  return std::make_shared<RobotWriters>(RobotWriters{std::move(publisher), std::move(receipts), std::move(events),
                                                     std::move(calibrations), std::move(statuses)});
}

std::shared_ptr<Outbox::RobotWriters> Outbox::WritersOf(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  const auto known = robots_.find(robot);
  if (known != robots_.end()) return known->second;
  if (robots_.size() >= kRobotsMax) {
    LogWarn("robot " + robot.str() + ": more than " + std::to_string(kRobotsMax) + " robots, it is not answered");
    return nullptr;
  }
  auto opened = OpenWriters(robot);
  if (!opened) {
    LogError(opened.error());
    return nullptr;
  }
  return robots_.emplace(robot, std::move(*opened)).first->second;
}

void Outbox::AddRobot(const RobotId& robot) { static_cast<void>(WritersOf(robot)); }

void Outbox::Send(const RobotId& partition, wire::Receipt receipt) {
  const auto writers = WritersOf(partition);
  if (writers == nullptr) return;
  receipt.sequence_number = ++sequence_number_;
  const auto owned = wire::ToReceipt(receipt);
  if (!owned) return LogError(owned.error());
  LogFailure(writers->receipts.Write(owned->sample));
  // A refusal is an answer to one request, not a state that a later client should find.
  if (receipt.state == wire::ReceiptState::kRefused) LogFailure(writers->receipts.Forget(owned->sample));
  if (receipt.state == wire::ReceiptState::kClosed) ForgetOldest(partition, receipt);
}

// A client that comes later sends its header again, so it is answered even if its receipt was forgotten here.
void Outbox::ForgetOldest(const RobotId& partition, const wire::Receipt& receipt) {
  Finished oldest;
  {
    const std::lock_guard lock(mutex_);
    finished_.push_back({partition, {}});
    finished_.back().receipt.robot = receipt.robot;
    finished_.back().receipt.subject_id = receipt.subject_id;
    if (finished_.size() <= kFinishedReceiptsMax) return;
    oldest = std::move(finished_.front());
    finished_.pop_front();
  }
  const auto writers = WritersOf(oldest.partition);
  const auto owned = wire::ToReceipt(oldest.receipt);
  if (writers != nullptr && owned) LogFailure(writers->receipts.Forget(owned->sample));
}

void Outbox::Send(const Announcement& announcement) {
  const auto writers = WritersOf(announcement.robot);
  if (writers == nullptr) return;
  rigcal_wire_Event sample{};
  sample.sequence_number = ++sequence_number_;
  if (const Status filled = FillEvent(announcement, sample); !filled) return LogError(filled.error());
  LogFailure(writers->events.Write(sample));
}

void Outbox::SendCalibration(const RobotId& robot, int revision, const SensorId& reference, const SensorPose& pose,
                             const Verdict& verdict, Stamp at) {
  const auto writers = WritersOf(robot);
  if (writers == nullptr) return;
  rigcal_wire_Calibration sample{};
  const auto fill = [&]() -> Status {
    RIGCAL_TRY(Put(robot.str(), sample.robot_id, "robot_id"));
    RIGCAL_TRY(Put(pose.sensor.str(), sample.sensor_id, "sensor_id"));
    RIGCAL_TRY(Put(reference.str(), sample.reference_id, "reference_id"));
    return Put(NameOf(verdict.level), sample.verdict, "verdict");
  };
  if (const Status filled = fill(); !filled) return LogError(filled.error());
  sample.revision = static_cast<std::uint32_t>(revision);
  sample.stamp_ns = at.ns;
  FillPose(pose, sample);
  LogFailure(writers->calibrations.Write(sample));
}

void Outbox::WithdrawCalibration(const RobotId& robot, const SensorId& sensor) {
  const auto writers = WritersOf(robot);
  if (writers == nullptr) return;
  rigcal_wire_Calibration key{};
  const auto fill = [&]() -> Status {
    RIGCAL_TRY(Put(robot.str(), key.robot_id, "robot_id"));
    return Put(sensor.str(), key.sensor_id, "sensor_id");
  };
  if (const Status filled = fill(); !filled) return LogError(filled.error());
  LogFailure(writers->calibrations.Forget(key));
}

void Outbox::SendStatus(const RobotId& robot, int revision, const Verdict& verdict, std::int64_t edges,
                        std::int64_t jobs_waiting, Stamp at) {
  const auto writers = WritersOf(robot);
  if (writers == nullptr) return;
  rigcal_wire_RobotStatus sample{};
  const auto fill = [&]() -> Status {
    RIGCAL_TRY(Put(robot.str(), sample.robot_id, "robot_id"));
    return Put(NameOf(verdict.level), sample.verdict, "verdict");
  };
  if (const Status filled = fill(); !filled) return LogError(filled.error());
  sample.revision = static_cast<std::uint32_t>(revision);
  sample.why = Borrow(verdict.why);
  sample.edges = static_cast<std::uint32_t>(edges);
  sample.jobs_waiting = static_cast<std::uint32_t>(jobs_waiting);
  sample.stamp_ns = at.ns;
  LogFailure(writers->statuses.Write(sample));
}

}  // namespace rigcal::dds

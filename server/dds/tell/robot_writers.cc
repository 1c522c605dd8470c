#include "server/dds/tell/robot_writers.h"

#include "server/base/log.h"

namespace rigcal::dds {
namespace {

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

Status FillKey(const RobotId& robot, const SensorId& sensor, rigcal_wire_Calibration& sample) {
  RIGCAL_TRY(Put(robot.str(), sample.robot_id, "robot_id"));
  return Put(sensor.str(), sample.sensor_id, "sensor_id");
}

}  // namespace

RobotWriters::RobotWriters(wire::Publisher publisher, wire::Writer<rigcal_wire_Receipt> receipts,
                           wire::Writer<rigcal_wire_Event> events, wire::Writer<rigcal_wire_Calibration> calibrations,
                           wire::Writer<rigcal_wire_RobotStatus> statuses)
    : publisher_(std::move(publisher)),
      receipts_(std::move(receipts)),
      events_(std::move(events)),
      calibrations_(std::move(calibrations)),
      statuses_(std::move(statuses)) {}

Result<std::shared_ptr<RobotWriters>> RobotWriters::Open(const wire::Participant& participant, const RobotId& robot) {
  RIGCAL_ASSIGN(auto publisher, wire::Publisher::Open(participant, wire::RobotPartition(robot)));
  RIGCAL_ASSIGN(auto receipts, wire::Writer<rigcal_wire_Receipt>::Open(participant, publisher));
  RIGCAL_ASSIGN(auto events, wire::Writer<rigcal_wire_Event>::Open(participant, publisher));
  RIGCAL_ASSIGN(auto calibrations, wire::Writer<rigcal_wire_Calibration>::Open(participant, publisher));
  RIGCAL_ASSIGN(auto statuses, wire::Writer<rigcal_wire_RobotStatus>::Open(participant, publisher));
  return std::shared_ptr<RobotWriters>(new RobotWriters(std::move(publisher), std::move(receipts), std::move(events),
                                                        std::move(calibrations), std::move(statuses)));
}

void RobotWriters::Send(const wire::Receipt& receipt) {
  const auto owned = wire::ToReceipt(receipt);
  if (!owned) return LogError(owned.error());
  LogFailure(receipts_.Write(owned->sample));
}

void RobotWriters::Forget(const wire::Receipt& receipt) {
  if (const auto owned = wire::ToReceipt(receipt)) LogFailure(receipts_.Forget(owned->sample));
}

void RobotWriters::Send(const Announcement& announcement, std::uint64_t sequence_number) {
  rigcal_wire_Event sample{};
  sample.sequence_number = sequence_number;
  if (const Status filled = FillEvent(announcement, sample); !filled) return LogError(filled.error());
  LogFailure(events_.Write(sample));
}

Status RobotWriters::TellStatus(const RobotState& state) {
  rigcal_wire_RobotStatus sample{};
  RIGCAL_TRY(Put(state.newest.robot.str(), sample.robot_id, "robot_id"));
  RIGCAL_TRY(Put(NameOf(state.newest.verdict.level), sample.verdict, "verdict"));
  sample.revision = static_cast<std::uint32_t>(state.newest.number);
  sample.why = Borrow(state.newest.verdict.why);
  sample.edges = static_cast<std::uint32_t>(state.edges);
  sample.stamp_ns = state.newest.created_at.ns;
  return statuses_.Write(sample);
}

Status RobotWriters::TellCalibration(const RobotState& state) {
  const RobotId& robot = state.newest.robot;
  const RobotState::Calibration& calibration = *state.calibration;
  if (calibration.revision.number == told_calibration_) return {};
  told_calibration_ = 0;
  std::set<SensorId> gone = told_sensors_;
  gone.insert(state.withdrawn.begin(), state.withdrawn.end());
  for (const SensorPose& pose : calibration.poses) {
    RIGCAL_ASSIGN(const auto owned, wire::ToCalibration(robot, calibration, pose));
    RIGCAL_TRY(calibrations_.Write(owned.sample));
    told_sensors_.insert(pose.sensor);
    gone.erase(pose.sensor);
  }
  RIGCAL_TRY(Withdraw(robot, gone));
  told_calibration_ = calibration.revision.number;
  return {};
}

Status RobotWriters::Withdraw(const RobotId& robot, const std::set<SensorId>& sensors) {
  for (const SensorId& sensor : sensors) {
    rigcal_wire_Calibration key{};
    RIGCAL_TRY(FillKey(robot, sensor, key));
    RIGCAL_TRY(calibrations_.Withdraw(key));
    told_sensors_.erase(sensor);
  }
  return {};
}

Status RobotWriters::TellPoses(const RobotState& state) {
  if (state.calibration) return TellCalibration(state);
  told_calibration_ = 0;
  std::set<SensorId> gone = told_sensors_;
  gone.insert(state.withdrawn.begin(), state.withdrawn.end());
  return Withdraw(state.newest.robot, gone);
}

// A reader of one topic that does not take keeps no other from being told.
Status RobotWriters::Tell(const RobotState& state) {
  const Status poses = TellPoses(state);
  const Status status = TellStatus(state);
  return poses ? status : poses;
}

bool RobotWriters::HasReaderBeside(const std::set<dds_instance_handle_t>& others) const {
  return receipts_.HasReaderBeside(others) || events_.HasReaderBeside(others) ||
         calibrations_.HasReaderBeside(others) || statuses_.HasReaderBeside(others);
}

}  // namespace rigcal::dds

// What one robot is told: four writers in its literal partition. Thread-safe. What cannot be written is logged, never waited for
// longer than a writer's blocking time.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>

#include "idl/convert.h"
#include "idl/dds.h"
#include "server/dds/service.h"

namespace rigcal::dds {

class RobotWriters {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // `partition`: the robot, or a name that no robot has, to see who reads of all of them.
  [[nodiscard]] static Result<std::shared_ptr<RobotWriters>> Open(const wire::Participant& participant, const RobotId& partition);

  void Send(const wire::Receipt& receipt);
  // Drops the receipt that is kept for who comes later.
  void Forget(const wire::Receipt& receipt);
  void Send(const Announcement& announcement, std::uint64_t sequence_number);
  // Nothing where a newer state was told. What was told of sensors is taken back where there is no calibration to use.
  void Tell(const RobotState& state);

  [[nodiscard]] bool HasReaders() const;
  // Since when it has had none; `now` where it has one.
  [[nodiscard]] Time QuietSince(Time now);

 private:
  RobotWriters(wire::Publisher publisher, wire::Writer<rigcal_wire_Receipt> receipts, wire::Writer<rigcal_wire_Event> events,
               wire::Writer<rigcal_wire_Calibration> calibrations, wire::Writer<rigcal_wire_RobotStatus> statuses);

  void TellStatus(const RobotState& state);
  void TellCalibration(const RobotId& robot, const RobotState::Calibration& calibration);
  // What was told of sensors, but for those in `kept`.
  void Withdraw(const RobotId& robot, const std::set<SensorId>& kept);

  wire::Publisher publisher_;
  wire::Writer<rigcal_wire_Receipt> receipts_;
  wire::Writer<rigcal_wire_Event> events_;
  wire::Writer<rigcal_wire_Calibration> calibrations_;
  wire::Writer<rigcal_wire_RobotStatus> statuses_;
  std::atomic<Time> quiet_since_;

  std::mutex mutex_;  // of what was told
  int told_revision_ = 0, told_calibration_ = 0;
  std::set<SensorId> told_sensors_;
};

}  // namespace rigcal::dds

// What one robot is told: four writers in its literal partition. Thread-safe, but for Tell. What cannot be written is
// never waited for longer than a writer's blocking time; of receipts and events it is logged.
#pragma once

#include <memory>
#include <set>

#include "idl/convert.h"
#include "idl/dds.h"
#include "server/dds/service.h"

namespace rigcal::dds {

class RobotWriters {
 public:
  // A writer of each topic in the robot's partition.
  [[nodiscard]] static Result<std::shared_ptr<RobotWriters>> Open(const wire::Participant& participant,
                                                                  const RobotId& robot);

  // What cannot be sent is logged.
  void Send(const wire::Receipt& receipt);
  // Drops the receipt that is kept for who comes later.
  void Forget(const wire::Receipt& receipt);
  void Send(const Announcement& announcement, std::uint64_t sequence_number);
  // From one thread. What was told of sensors that are not in the calibration is taken back, by these writers and,
  // where there is no calibration to use, also by those of an earlier run. Who joins later is told as much. After an
  // error all of it is told again.
  [[nodiscard]] Status Tell(const RobotState& state);

  // Whether anybody reads of the robot beside `others`, who read of many.
  [[nodiscard]] bool HasReaderBeside(const std::set<dds_instance_handle_t>& others) const;

 private:
  RobotWriters(wire::Publisher publisher, wire::Writer<rigcal_wire_Receipt> receipts,
               wire::Writer<rigcal_wire_Event> events, wire::Writer<rigcal_wire_Calibration> calibrations,
               wire::Writer<rigcal_wire_RobotStatus> statuses);

  [[nodiscard]] Status TellStatus(const RobotState& state);
  [[nodiscard]] Status TellPoses(const RobotState& state);
  [[nodiscard]] Status TellCalibration(const RobotState& state);
  [[nodiscard]] Status Withdraw(const RobotId& robot, const std::set<SensorId>& sensors);

  wire::Publisher publisher_;
  wire::Writer<rigcal_wire_Receipt> receipts_;
  wire::Writer<rigcal_wire_Event> events_;
  wire::Writer<rigcal_wire_Calibration> calibrations_;
  wire::Writer<rigcal_wire_RobotStatus> statuses_;

  int told_calibration_ = 0;         // its revision, if all of it was told; of Tell's thread, as the next
  std::set<SensorId> told_sensors_;  // that readers may hold from these writers
};

}  // namespace rigcal::dds

// What the server tells of its own accord: one set of writers per robot, in that robot's literal partition. Thread-safe. What
// cannot be written is logged, never waited for longer than a writer's blocking time.
#pragma once

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "idl/convert.h"
#include "idl/dds.h"
#include "server/dds/service.h"

namespace rigcal::dds {

class Outbox {
 public:
  explicit Outbox(const wire::Participant& participant) : participant_(participant) {}

  // A no-op if the robot is known. Done early so that readers match before there is something to tell.
  void AddRobot(const RobotId& robot);
  // Sets the sequence number. Goes out in the partition of `partition`, usually the receipt's robot.
  void Send(const RobotId& partition, wire::Receipt receipt);
  void Send(const Announcement& announcement);
  void SendCalibration(const RobotId& robot, int revision, const SensorId& reference, const SensorPose& pose,
                       const Verdict& verdict, Stamp at);
  void WithdrawCalibration(const RobotId& robot, const SensorId& sensor);
  void SendStatus(const RobotId& robot, int revision, const Verdict& verdict, std::int64_t edges,
                  std::int64_t jobs_waiting, Stamp at);

 private:
  struct RobotWriters {
    wire::Publisher publisher;
    wire::Writer<rigcal_wire_Receipt> receipts;
    wire::Writer<rigcal_wire_Event> events;
    wire::Writer<rigcal_wire_Calibration> calibrations;
    wire::Writer<rigcal_wire_RobotStatus> statuses;
  };
  struct Finished {
    RobotId partition;
    wire::Receipt receipt;
  };

  [[nodiscard]] Result<std::shared_ptr<RobotWriters>> OpenWriters(const RobotId& robot) const;
  [[nodiscard]] std::shared_ptr<RobotWriters> WritersOf(const RobotId& robot);  // null: logged
  void ForgetOldest(const RobotId& partition, const wire::Receipt& receipt);

  const wire::Participant& participant_;
  std::atomic<std::uint64_t> sequence_number_{0};
  std::mutex mutex_;
  std::map<RobotId, std::shared_ptr<RobotWriters>> robots_;
  std::deque<Finished> finished_;  // newest last: receipts that late joiners may still want
};

}  // namespace rigcal::dds

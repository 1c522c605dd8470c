// Everything the server writes: one set of writers per robot, in that robot's literal partition. Thread-safe. What
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
  // `reply_matched`: called from a thread of DDS when a reader of replies came or went.
  Outbox(const wire::Participant& participant, std::function<void()> reply_matched);

  // A no-op if the robot is known. Done early so that readers match before there is something to tell.
  void AddRobot(const RobotId& robot);
  // Sets the sequence number. Goes out in the partition of `partition`, usually the receipt's robot.
  void Send(const RobotId& partition, wire::Receipt receipt);
  void Send(const Announcement& announcement);
  void SendCalibration(const RobotId& robot, int revision, const SensorId& reference, const SensorPose& pose,
                       const Verdict& verdict, Stamp at);
  void SendStatus(const RobotId& robot, int revision, const Verdict& verdict, std::int64_t edges,
                  std::int64_t jobs_waiting, Stamp at);

  // Makes the reply writer of a partition, so that a client can find it before it asks.
  [[nodiscard]] Status AddAsker(const std::string& partition);
  // One part of a reply, in the partition where the request came from ("operator" or "robot/<id>"). kUnreachable if the
  // participant that asked has no matched reader yet; kBusy if its reader does not take.
  [[nodiscard]] Status Reply(const std::string& partition, dds_instance_handle_t participant,
                             const rigcal_wire_Reply& part);

 private:
  struct RobotWriters {
    wire::Writer<rigcal_wire_Receipt> receipts;
    wire::Writer<rigcal_wire_Event> events;
    wire::Writer<rigcal_wire_Calibration> calibrations;
    wire::Writer<rigcal_wire_RobotStatus> statuses;
  };
  using ReplyWriter = wire::Writer<rigcal_wire_Reply>;
  struct Finished {
    RobotId partition;
    wire::Receipt receipt;
  };

  [[nodiscard]] Result<std::shared_ptr<RobotWriters>> OpenWriters(const RobotId& robot) const;
  [[nodiscard]] std::shared_ptr<RobotWriters> WritersOf(const RobotId& robot);  // null: logged
  [[nodiscard]] Result<std::shared_ptr<ReplyWriter>> ReplyWriterOf(const std::string& partition);
  void ForgetOldest(const RobotId& partition, const wire::Receipt& receipt);

  const wire::Participant& participant_;
  std::function<void()> reply_matched_;
  std::atomic<std::uint64_t> sequence_number_{0};
  std::mutex mutex_;
  std::map<RobotId, std::shared_ptr<RobotWriters>> robots_;
  std::map<std::string, std::shared_ptr<ReplyWriter>> replies_;
  std::deque<Finished> finished_;  // newest last: receipts that late joiners may still want
};

}  // namespace rigcal::dds

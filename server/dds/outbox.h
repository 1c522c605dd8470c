// What the server tells of its own accord, and to whom: a robot has writers (robot_writers.h) while somebody reads of it. Thread-safe.
// A robot that nobody reads of costs nothing, however many are stored; who begins to read is told what is stored.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/dds/robot_writers.h"

namespace rigcal::dds {

class Outbox {
 public:
  // `met` is called, from any thread and without waiting, when a robot got writers: its state is then to be told.
  Outbox(const wire::Participant& participant, std::function<void(const RobotId&)> met)
      : participant_(participant), met_(std::move(met)) {}

  // The topics it writes: who reads one of them in a robot's partition is to be met.
  [[nodiscard]] static const std::vector<std::string>& Topics();
  // Somebody reads of the robot. A no-op if it has writers.
  void Meet(const RobotId& robot) { static_cast<void>(Opened(robot)); }
  // Sets the sequence number. Goes out in the partition of `partition`, usually the receipt's robot, which is met.
  void Send(const RobotId& partition, wire::Receipt receipt);
  // To those who read of the robot.
  void Send(const Announcement& announcement);
  void Tell(const RobotState& state);
  // Ends the writers of robots of which nobody has read for a while. From one thread, again and again.
  void CloseQuiet();

 private:
  struct Finished {
    RobotId partition;
    wire::Receipt receipt;
  };
  using Writers = std::shared_ptr<RobotWriters>;

  [[nodiscard]] Writers Opened(const RobotId& robot);  // null: logged
  [[nodiscard]] Writers Find(const RobotId& robot);    // null: it has none
  // Null: nobody reads of the robot. Who reads of all robots at once hears of each that has news.
  [[nodiscard]] Writers Heard(const RobotId& robot);
  void ForgetOldest(const RobotId& partition, const wire::Receipt& receipt);

  const wire::Participant& participant_;
  const std::function<void(const RobotId&)> met_;
  std::atomic<std::uint64_t> sequence_number_{0};
  std::mutex mutex_;
  std::map<RobotId, Writers> robots_;
  Writers of_all_;                 // in a partition that only who reads of all robots matches
  RobotWriters::Time next_look_{};  // for quiet ones
  std::deque<Finished> finished_;  // newest last: receipts that late joiners may still want
};

}  // namespace rigcal::dds

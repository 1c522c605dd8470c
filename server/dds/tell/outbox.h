// What the server tells of its own accord, and to whom: a robot has writers (robot_writers.h) while somebody reads of
// it. Thread-safe. A robot that nobody reads of costs nothing, however many are stored; who begins to read is told what
// is stored.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/dds/tell/robot_writers.h"

namespace rigcal::dds {

class Outbox {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // How many robots may have writers: because somebody reads of that robot, and beside these because there is news of
  // it for who reads of many robots at once. A participant may have 16,382 publishers.
  struct Limits {
    std::size_t listened_to = 15'000, with_news = 1'000;
  };

  // `met` is called, from any thread and without waiting, when somebody reads of a robot that nobody read of before:
  // its state is then to be told.
  // `receipt_sent`: Callbacks (service.h); none: nobody waits for receipts but by DDS.
  Outbox(const wire::Participant& participant, std::function<void(const RobotId&)> met,
         std::function<bool(const wire::Receipt&)> receipt_sent = {})
      : Outbox(participant, std::move(met), Limits{}, std::chrono::steady_clock::now) {
    receipt_sent_ = std::move(receipt_sent);
  }
  Outbox(const wire::Participant& participant, std::function<void(const RobotId&)> met, const Limits& limits,
         std::function<Time()> now)
      : participant_(participant), met_(std::move(met)), limits_(limits), now_(std::move(now)) {}

  // The topics it writes: who reads one of them in a robot's partition is to be met.
  [[nodiscard]] static const std::vector<std::string>& Topics();
  // Somebody reads of the robot, or will as soon as DDS has matched the reader: its writers stay a while longer.
  void Meet(const RobotId& robot) { static_cast<void>(ListenedTo(robot)); }
  // All that read of many robots at once (wire::NewReaders::OfMany): they hear of each robot that has news, and keep no
  // writers for themselves.
  void NoteReadersOfMany(const std::set<dds_instance_handle_t>& readers);
  // Whether anybody would hear of the robot.
  [[nodiscard]] bool IsHeardOf(const RobotId& robot);

  // Sets the sequence number. Goes out in the partition of `partition`, usually the receipt's robot, which is met; not
  // where nobody reads of it and whoever waits for the receipt has it by another way.
  void Send(const RobotId& partition, wire::Receipt receipt);
  // To those who read of the robot.
  void Send(const Announcement& announcement);
  // For so long, announcements are kept: who read before all of DDS was opened anew is met again by then. Beyond
  // kHeldMax the oldest are dropped.
  void HoldAnnouncements(std::chrono::milliseconds time);
  static constexpr std::size_t kHeldMax = 10'000;
  // Those that are still kept, oldest first; they are not sent from here any more.
  [[nodiscard]] std::deque<Announcement> TakeHeld();
  // Likewise; of one thread, each state as new as the one before or newer. An error: who reads may have heard a part of
  // it.
  [[nodiscard]] Status Tell(const RobotState& state);
  // Ends the writers of robots of which nobody has read for a while, and sends announcements that were kept long
  // enough. From one thread, again and again.
  void CloseQuiet();

 private:
  struct Finished {
    RobotId partition;
    wire::Receipt receipt;
  };
  using Writers = std::shared_ptr<RobotWriters>;
  struct Live {
    Writers writers;
    Time quiet_since;
  };
  using Robots = std::map<RobotId, Live>;

  [[nodiscard]] Writers ListenedTo(const RobotId& robot);  // opened if need be; null: logged
  [[nodiscard]] Writers WithNews(const RobotId& robot);    // likewise; null also where nobody would hear
  [[nodiscard]] Writers Find(const RobotId& robot);        // null: nobody reads of it
  [[nodiscard]] Writers Opened(const RobotId& robot);      // call with mutex_, as the next two; null: logged
  void WarnFull(const std::string& warning);
  void EndQuiet(Robots& robots, Time now, std::vector<Writers>& ended);
  void ForgetOldest(const RobotId& partition, const wire::Receipt& receipt);
  [[nodiscard]] bool Held(const Announcement& announcement);
  [[nodiscard]] std::optional<Announcement> NextHeld();
  void SendHeld();

  const wire::Participant& participant_;
  const std::function<void(const RobotId&)> met_;
  std::function<bool(const wire::Receipt&)> receipt_sent_;
  const Limits limits_;
  const std::function<Time()> now_;
  std::atomic<std::uint64_t> sequence_number_{0};
  std::mutex mutex_;
  Robots listened_to_, with_news_;  // a robot is in one of them
  std::set<dds_instance_handle_t> of_many_;
  bool full_ = false;  // and it was said
  Time next_look_{};   // for quiet ones
  Time held_until_{};
  std::deque<Announcement> held_;  // oldest first
  bool going_out_ = false;         // one that was held is being sent
  std::deque<Finished> finished_;  // newest last: receipts that late joiners may still want
};

}  // namespace rigcal::dds

// The sessions that are being received: so many at once, in memory and on disk. Thread W only, but for Count.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "server/dds/record/session_intake.h"

namespace rigcal::dds {

class OpenSessions {
 public:
  // Empties `folder`, in which each has one of its own: what was not receipted before is sent again.
  OpenSessions(std::filesystem::path folder, std::uint64_t incarnation);

  // Null: it is none of them. It is the one used last, then.
  [[nodiscard]] SessionIntake* Find(const SessionId& session);
  // One that is there.
  [[nodiscard]] SessionIntake& At(const SessionId& session) { return *intakes_.at(session); }
  // The one that was used longest ago, where one has to go before another of so many payloads is added.
  [[nodiscard]] std::optional<SessionId> InTheWayOf(std::size_t payloads) const;
  // `held`: as stored. kStorage where it can have no folder.
  [[nodiscard]] Result<SessionIntake*> Add(const RobotId& robot, const SessionId& session, const Manifest& manifest,
                                           const std::vector<bool>& held);
  // A session that comes back after this must send again what is not held: for it the server is a new one.
  void Remove(const SessionId& session);

  // Those whose clients want to hear how far they are.
  [[nodiscard]] std::set<SessionId>& dirty() { return dirty_; }
  // For receipts: another one says that what is not held is to be sent again.
  [[nodiscard]] std::uint64_t incarnation() const { return incarnation_; }
  [[nodiscard]] std::size_t Count() const { return count_; }  // any thread

 private:
  const std::filesystem::path folder_;
  std::uint64_t incarnation_, uses_ = 0;
  std::size_t payloads_ = 0;
  std::unordered_map<SessionId, std::unique_ptr<SessionIntake>> intakes_;
  std::set<SessionId> dirty_;
  std::atomic<std::size_t> count_{0};  // as many as intakes_
};

}  // namespace rigcal::dds

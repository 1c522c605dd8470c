#include "server/dds/record/open_sessions.h"

#include <algorithm>

#include "server/base/limits_in_force.h"

namespace rigcal::dds {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kOpenPayloadsMax = 1'000'000;  // of all sessions that are being received: bounds memory

}  // namespace

OpenSessions::OpenSessions(fs::path folder, std::uint64_t incarnation)
    : folder_(std::move(folder)), incarnation_(incarnation) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) fs::remove_all(entry.path(), ignored);
}

SessionIntake* OpenSessions::Find(const SessionId& session) {
  const auto found = intakes_.find(session);
  if (found == intakes_.end()) return nullptr;
  found->second->last_used = ++uses_;
  return found->second.get();
}

std::optional<SessionId> OpenSessions::InTheWayOf(std::size_t payloads) const {
  const auto sessions_max = static_cast<std::size_t>(limits::InForce().open_sessions);
  if (intakes_.empty() || (intakes_.size() < sessions_max && payloads_ + payloads <= kOpenPayloadsMax))
    return std::nullopt;
  const auto later = [](const auto& a, const auto& b) { return a.second->last_used < b.second->last_used; };
  return std::min_element(intakes_.begin(), intakes_.end(), later)->first;
}

Result<SessionIntake*> OpenSessions::Add(const RobotId& robot, const SessionId& session, const Manifest& manifest,
                                         const std::vector<bool>& held) {
  const fs::path folder = folder_ / session.str();
  std::error_code code;
  fs::create_directories(folder, code);
  if (code)
    return Fail(ErrorCode::kStorage, folder.string() + ": cannot be made (" + code.message() + ")",
                "Check that the disk has free space and that the server may write to it");
  auto intake = std::make_unique<SessionIntake>(robot, session, manifest, held, folder, incarnation_);
  intake->last_used = ++uses_;
  payloads_ += intake->payloads();
  SessionIntake* added = intakes_.emplace(session, std::move(intake)).first->second.get();
  count_ = intakes_.size();
  return added;
}

void OpenSessions::Remove(const SessionId& session) {
  const auto found = intakes_.find(session);
  if (found == intakes_.end()) return;
  std::error_code ignored;
  fs::remove_all(found->second->folder(), ignored);
  payloads_ -= found->second->payloads();
  if (!found->second->AllHeld()) ++incarnation_;
  intakes_.erase(found);
  count_ = intakes_.size();
  dirty_.erase(session);
}

}  // namespace rigcal::dds

#include "server/pipeline/revisions/revision_due.h"

#include "storage/revisions/revisions.h"

namespace rigcal::pipeline {
namespace {

constexpr std::int64_t kUnsolvedMax_ns = 45'000'000'000;
constexpr std::int64_t kPressing_ns = 10'000'000'000;

}  // namespace

Result<bool> IsRevisionDue(storage::Store& store, Stamp now, const RobotId& robot, std::int64_t jobs) {
  if (jobs == 0) return true;
  RIGCAL_ASSIGN(const auto since, storage::LoadUnsolvedSince(store, robot));
  const std::int64_t waited_ns = since ? now.ns - since->ns : 0;
  return waited_ns >= kUnsolvedMax_ns || waited_ns < 0;  // the clock was set back
}

Result<bool> IsRevisionPressing(storage::Store& store, Stamp now) {
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(store));
  if (unsolved.empty()) return false;
  RIGCAL_ASSIGN(const auto since, storage::LoadUnsolvedSince(store, unsolved.front()));
  return since && now.ns - since->ns >= kPressing_ns;
}

}  // namespace rigcal::pipeline

#include "server/model/sessions/recomputation.h"

#include <array>

namespace rigcal {
namespace {

constexpr std::array<const char*, 4> kSessionAnewNames = {"computed", "same", "kept", "failed"};
constexpr std::array<const char*, 3> kRobotAnewNames = {"changed", "unchanged", "failed"};

}  // namespace

std::string ScopeText(const RecomputationRun& run) {
  if (run.scope == "model") return "rig model " + run.subject;
  if (run.scope == "robot") return "robot " + run.subject;
  if (run.scope == "board") return "the robots that board " + run.subject + " was shown to";
  return "all robots";
}

std::string CauseText(const RecomputationRun& run) {
  const std::string cause = "re-computed with rigcal " + run.software + ", estimator " + run.estimator;
  return run.scope == "board" ? cause + ", board " + run.subject + " with its measured size" : cause;
}

std::string NameOf(SessionAnew how) { return kSessionAnewNames.at(static_cast<std::size_t>(how)); }

std::string NameOf(RobotAnew how) { return kRobotAnewNames.at(static_cast<std::size_t>(how)); }

RobotAnew RobotAnewOf(const std::string& name) {
  for (const RobotAnew how : {RobotAnew::kChanged, RobotAnew::kUnchanged})
    if (NameOf(how) == name) return how;
  return RobotAnew::kFailed;
}

}  // namespace rigcal

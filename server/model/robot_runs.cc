#include "server/model/robot_runs.h"

namespace rigcal {
namespace {

std::string TroubleOf(const RobotRuns& runs, bool was_approved, const std::optional<UsableRevision>& in_use) {
  if (runs.revision == 0)
    return "It runs a calibration that nobody approved here (sha256 " + runs.report.digest.str().substr(0, 12) + ").";
  if (in_use && in_use->number == runs.revision) return "";
  const std::string what =
      "It runs revision " + std::to_string(runs.revision) + (was_approved ? "; " : ", which nobody approved; ");
  if (!in_use) return what + "no calibration of it is in use.";
  return what + "revision " + std::to_string(in_use->number) + " is in use: not applied yet.";
}

}  // namespace

Runs RunsOf(const RobotRuns& runs, bool was_approved, const std::optional<UsableRevision>& in_use) {
  return {runs.revision, TroubleOf(runs, was_approved, in_use)};
}

}  // namespace rigcal

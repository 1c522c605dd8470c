#include "server/model/robots/robot_runs.h"

namespace rigcal {
namespace {

std::string WhatRuns(const RobotRuns& runs, bool was_approved, const std::optional<Decision>& decision) {
  if (runs.revision == 0)
    return "a calibration that nobody approved here (sha256 " + runs.report.digest.str().substr(0, 12) + ")";
  const std::string revision = "revision " + std::to_string(runs.revision);
  if (decision && decision->how == "rejected")
    return revision + ", which was rejected by " + decision->word.who + ", " + DayText(decision->word.at);
  return revision + (was_approved ? "" : ", which nobody approved");
}

std::string TroubleOf(int runs, const std::string& what, const std::optional<UsableRevision>& in_use) {
  if (runs == 0) return "It runs " + what + ".";
  if (!in_use) return "It runs " + what + "; no calibration of it is in use.";
  if (in_use->number == runs) return "";
  return "It runs " + what + "; revision " + std::to_string(in_use->number) + " is in use: not applied yet.";
}

}  // namespace

Runs RunsOf(const RobotRuns& runs, bool was_approved, const std::optional<Decision>& decision,
            const std::optional<UsableRevision>& in_use, const std::optional<Stamp>& in_use_since) {
  const std::string what = WhatRuns(runs, was_approved, decision);
  Runs told{runs.revision, TroubleOf(runs.revision, what, in_use), what, runs.report.digest};
  const bool was_in_use = runs.revision > 0 && was_approved;  // what nobody approved it should never have run
  if (!told.trouble.empty() && in_use && in_use_since && was_in_use)
    told.apply_by = Stamp{in_use_since->ns + kApplyWithin_ns};
  return told;
}

}  // namespace rigcal

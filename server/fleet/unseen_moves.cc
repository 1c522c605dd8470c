// What a session could not have seen: sensors that could have been bumped during it without a word.
#include <algorithm>
#include <cmath>
#include <set>

#include "server/fleet/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

struct Unseen {
  SensorId sensor;
  SessionId session;
  SmallestMove move;
};

// Of each sensor the newest session that tells of it.
std::vector<Unseen> NewestMovesOf(const std::vector<SessionEstimate>& estimates) {
  std::vector<Unseen> newest;
  std::set<SensorId> judged;
  for (const SessionEstimate& estimate : estimates)
    for (const RefinedPose& pose : estimate.poses)
      if (pose.smallest_move && judged.insert(pose.sensor).second)
        newest.push_back({pose.sensor, estimate.session, *pose.smallest_move});
  return newest;
}

// Times the tolerance, whichever of the two is exceeded more.
double TimesTheTolerance(const SmallestMove& move, const Policy& policy) {
  return std::max(move.m / policy.unseen_move_max_m, move.rad / policy.unseen_move_max_rad);
}

bool IsAnyMove(const SmallestMove& move) { return move.m >= kAnyMove_m || move.rad >= kAnyMove_rad; }

std::string SizeText(const SmallestMove& move) {
  return Number(1e3 * move.m, "mm") + " or " + Number(kDegreesPerRadian * move.rad, "deg");
}

// Sigmas fall with the root of the captures.
std::string MorePlaces(const Unseen& worst, const Policy& policy) {
  const std::string seen = "; it saw something in " + std::to_string(worst.move.captures) + " captures";
  if (IsAnyMove(worst.move)) return "Capture more places that " + worst.sensor.str() + " sees" + seen;
  const double enough = worst.move.captures * std::pow(TimesTheTolerance(worst.move, policy), 2);
  return "Capture at least " + std::to_string(static_cast<long>(std::ceil(enough))) + " places that " +
         worst.sensor.str() + " sees" + seen;
}

}  // namespace

std::optional<Finding> FindUnseenMoves(const std::vector<SessionEstimate>& estimates, const Policy& policy,
                                       const SessionTimes& captured_at) {
  std::vector<Unseen> unseen = NewestMovesOf(estimates);
  std::erase_if(unseen, [&](const Unseen& one) { return TimesTheTolerance(one.move, policy) <= 1; });
  if (unseen.empty()) return std::nullopt;
  std::stable_sort(unseen.begin(), unseen.end(), [&](const Unseen& x, const Unseen& y) {
    return TimesTheTolerance(x.move, policy) > TimesTheTolerance(y.move, policy);
  });
  const Unseen& worst = unseen.front();
  std::vector<std::string> names;
  for (const Unseen& one : unseen) names.push_back(one.sensor.str());
  Finding finding;
  const bool one = names.size() == 1;
  const std::string size = IsAnyMove(worst.move) ? "" : "by up to " + SizeText(worst.move);
  finding.why = "a bump of " + std::string(one ? "" : "any of ") + List(names) +
                (one && !size.empty() ? " " + size : "") + " half-way through the session of " +
                NameOfSession(worst.session, captured_at) + " would not have been noticed" +
                (one || size.empty() ? "" : ", of " + worst.sensor.str() + " " + size);
  finding.what_to_do = MorePlaces(worst, policy);
  return finding;
}

std::string SmallestMoveNoticed(const std::vector<SessionEstimate>& estimates) {
  SmallestMove largest{0.0, 0.0, 0};
  for (const Unseen& one : NewestMovesOf(estimates)) {
    largest.m = std::max(largest.m, one.move.m);
    largest.rad = std::max(largest.rad, one.move.rad);
  }
  if (largest.m == 0.0 || IsAnyMove(largest)) return "";
  return "A bump of any sensor by " + SizeText(largest) + " half-way through a session would have been noticed.";
}

}  // namespace rigcal::fleet

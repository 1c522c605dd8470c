// What a session could not have seen: sensors that could have been bumped during it without a word.
#include <algorithm>
#include <cmath>
#include <set>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

struct Unseen {
  SensorId sensor;
  SessionId session;
  SmallestMove move;
  bool by_pairs = false;  // no refinement looked at it
};

bool IsRefinementFailed(const SessionEstimate& estimate) {
  return !estimate.why_not.empty() && estimate.why_not.front().code == kRefinementFailed;
}

// Of each sensor the newest session that tells of it. Where the refinement failed, FindUnrefined says so.
std::vector<Unseen> NewestMovesOf(const std::vector<SessionEstimate>& estimates) {
  std::vector<Unseen> newest;
  std::set<SensorId> judged;
  for (const SessionEstimate& estimate : estimates) {
    for (const RefinedPose& pose : estimate.poses)
      if (pose.smallest_move && judged.insert(pose.sensor).second)
        newest.push_back({pose.sensor, estimate.session, *pose.smallest_move});
    for (const SmallestMoveByPairs& one : estimate.by_pairs)
      if (!IsRefinementFailed(estimate) && judged.insert(one.sensor).second)
        newest.push_back({one.sensor, estimate.session, one.move, true});
  }
  return newest;
}

// Known sensors of which no session tells.
std::vector<std::string> WithoutSession(const std::vector<Unseen>& told, const GraphSolution& solution) {
  std::vector<std::string> untold;
  for (const SensorPose& pose : solution.poses) {
    const auto tells = [&](const Unseen& one) { return one.sensor == pose.sensor; };
    if (pose.known && std::none_of(told.begin(), told.end(), tells)) untold.push_back(pose.sensor.str());
  }
  return untold;
}

// Times what the policy allows, whichever of the two is exceeded more.
double TimesAllowed(const Unseen& one, const Policy& policy) {
  const PoseLimit allowed = LimitsOf(policy, one.sensor).unseen_move;
  return std::max(one.move.m / allowed.m, one.move.rad / allowed.rad);
}

bool IsAnyMove(const SmallestMove& move) { return move.m >= kAnyMove_m || move.rad >= kAnyMove_rad; }

std::string SizeText(const SmallestMove& move) {
  return Number(1e3 * move.m, "mm") + " or " + Number(kDegreesPerRadian * move.rad, "deg");
}

// Of the half by which `move` is beyond it; of both, where both are.
std::string AllowedText(const SmallestMove& move, const PoseLimit& allowed) {
  const std::string shift = TwoDigits(1e3 * allowed.m, "mm"), turn = TwoDigits(kDegreesPerRadian * allowed.rad, "deg");
  if (move.rad <= allowed.rad) return " (limit " + shift + ")";
  return " (limit " + (move.m <= allowed.m ? turn : shift + " or " + turn) + ")";
}

// How many times as many captures would bring `told` down to `tolerance`: sigmas fall with their root, the size below
// which nothing is told as a move does not.
double TimesTheCaptures(double told, double tolerance, double least) {
  return std::max(std::pow(told / tolerance, 2), std::pow((told - least) / (tolerance - least), 2));
}

// Nobody takes so many: the boards must tell more.
constexpr long kPlacesMax = 400;

struct Advice {
  std::string text;
  long captures = 0;  // that it asks for; 0: it does not say how many
};
Advice MorePlaces(const Unseen& worst, const Policy& policy) {
  const std::string seen = std::to_string(worst.move.captures), places = " places that " + worst.sensor.str() + " sees";
  if (IsAnyMove(worst.move)) return {"Capture more than " + seen + places};
  const PoseLimit allowed = LimitsOf(policy, worst.sensor).unseen_move;
  if (allowed.m <= kMovedMin_m || allowed.rad <= kMovedMin_rad)
    return {"Allow a larger unseen bump: one below 1 mm and 1 mrad is not told"};
  const double times = std::max(TimesTheCaptures(std::max(worst.move.m, allowed.m), allowed.m, kMovedMin_m),
                                TimesTheCaptures(std::max(worst.move.rad, allowed.rad), allowed.rad, kMovedMin_rad));
  const long needed = static_cast<long>(std::ceil(std::min(worst.move.captures * times, 1e9)));
  if (needed > kPlacesMax && worst.by_pairs)
    return {
        "Capture again where both sensors of a pair see more, in more directions, or show a board to a camera "
        "beside " +
        worst.sensor.str() + " (more places alone: " + std::to_string(needed) + " instead of " + seen + ")"};
  if (needed > kPlacesMax)
    return {"Capture again with boards nearer to " + worst.sensor.str() +
            " and more tilted (more places alone: " + std::to_string(needed) + " instead of " + seen + ")"};
  return {"Capture at least " + std::to_string(needed) + places + " (this session had " + seen + ")", needed};
}

// Sensors of the newest session that nothing in it ties to the others: a move of them all at once it does not see.
std::string IslandsText(const std::vector<SessionEstimate>& estimates) {
  std::string text;
  bool is_first = true;
  for (const SessionEstimate& estimate : estimates) {
    if (estimate.session != estimates.front().session) break;
    if (!estimate.why_not.empty()) continue;
    std::vector<std::string> names;
    for (const RefinedPose& pose : estimate.poses) names.push_back(pose.sensor.str());
    if (!is_first)
      text += " Whether " + List(names) + " moved together is not known: nothing in the session ties them to the rest.";
    is_first = false;
  }
  return text;
}

}  // namespace

std::optional<Finding> FindUnseenMoves(const std::vector<SessionEstimate>& estimates, const Policy& policy,
                                       const SessionTimes& captured_at) {
  std::vector<Unseen> unseen = NewestMovesOf(estimates);
  std::erase_if(unseen, [&](const Unseen& one) { return TimesAllowed(one, policy) <= 1; });
  if (unseen.empty()) return std::nullopt;
  std::stable_sort(unseen.begin(), unseen.end(),
                   [&](const Unseen& x, const Unseen& y) { return TimesAllowed(x, policy) > TimesAllowed(y, policy); });
  const Unseen worst = unseen.front();
  std::vector<std::string> names;
  for (const Unseen& one : unseen)
    if (one.session == worst.session) names.push_back(one.sensor.str());
  Finding finding;
  for (const Unseen& one : unseen)
    if (one.session == worst.session) finding.accused.push_back(one.sensor);
  const bool one = names.size() == 1;
  const std::string size =
      IsAnyMove(worst.move)
          ? ""
          : "by up to " + SizeText(worst.move) + AllowedText(worst.move, LimitsOf(policy, worst.sensor).unseen_move);
  finding.why = "a bump of " + List(names) + (one && !size.empty() ? " " + size : "") +
                " half-way through the session of " + NameOfSession(worst.session, captured_at) + " would go unseen" +
                (one || size.empty() ? "" : ", of " + worst.sensor.str() + " " + size);
  Advice advice = MorePlaces(worst, policy);
  finding.what_to_do = std::move(advice.text);
  finding.captures = advice.captures;
  return finding;
}

std::optional<Finding> FindUnrefined(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at) {
  const auto failed = std::find_if(estimates.begin(), estimates.end(), [&](const SessionEstimate& estimate) {
    return estimate.session == estimates.front().session && IsRefinementFailed(estimate);  // of the newest, an island
  });
  if (failed == estimates.end()) return std::nullopt;
  const Diagnosis& why = failed->why_not.front();
  const std::string part =
      failed == estimates.begin() ? "" : failed->reference.str() + " and the sensors that are tied to it, in ";
  return Finding{part + "the session of " + NameOfSession(estimates.front().session, captured_at) +
                     (part.empty() ? "" : ",") + " could not be refined as a whole (" + why.what +
                     "): a bump during it would go unseen",
                 why.cure.substr(0, why.cure.find_last_not_of('.') + 1)};
}

std::string SmallestMoveNoticed(const std::vector<SessionEstimate>& estimates, const GraphSolution& solution) {
  SmallestMove largest{0.0, 0.0, 0};
  const std::vector<Unseen> told = NewestMovesOf(estimates);
  for (const Unseen& one : told) {
    largest.m = std::max(largest.m, one.move.m);
    largest.rad = std::max(largest.rad, one.move.rad);
  }
  const bool is_any_refined = std::any_of(estimates.begin(), estimates.end(), [&](const SessionEstimate& estimate) {
    return estimate.session == estimates.front().session && estimate.why_not.empty();  // an island, where not the whole
  });
  if (!estimates.empty() && !is_any_refined && estimates.front().by_pairs.empty())
    return "Whether a sensor was bumped during the newest session is not known: it was judged pair by pair only, as " +
           estimates.front().why_not.front().what + ".";
  if (told.empty() || IsAnyMove(largest)) return "";
  const std::vector<std::string> untold = WithoutSession(told, solution);
  return "A bump of any sensor " + (untold.empty() ? "" : "but " + List(untold) + " ") + "by " + SizeText(largest) +
         " half-way through a session would have been noticed" +
         (untold.empty() ? "." : "; of " + List(untold) + " it is not known.") + IslandsText(estimates);
}

}  // namespace rigcal::fleet

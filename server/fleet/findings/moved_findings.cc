#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"
#include "server/model/approval/standing.h"

namespace rigcal::fleet {

namespace {

// Of sensors that had two poses, or sat elsewhere.
template <typename Move>
bool IsSmallMove(const Move& move, const Policy& policy) {
  return !IsBeyond(move.step, LimitsOf(policy, move.sensor).moved_min);
}

template <typename Move>
std::vector<Move> LargeOnes(const std::vector<Move>& moves, const Policy& policy) {
  std::vector<Move> large = moves;
  std::erase_if(large, [&](const Move& move) { return IsSmallMove(move, policy); });
  return large;
}

std::string FocalText(const FocalChange& lens) {
  if (std::abs(lens.focal_ratio) < 3 * lens.sigma_ratio) return "its picture is shifted";
  return "its focal length is " + TwoDigits(100 * std::abs(lens.focal_ratio), "%") +
         (lens.focal_ratio > 0 ? " longer" : " shorter");
}

bool IsOfLens(const SensorMovedWithin& move) { return move.lens && move.lens->surely; }

// Any of them may have moved: the session tells only that they did against each other.
std::vector<std::string> MountsOf(const SensorMovedWithin& move) {
  std::vector<std::string> names = {move.sensor.str()};
  if (!move.or_sensor.empty()) names.push_back(move.or_sensor.str());
  return names;
}

std::string EitherOf(const SensorMovedWithin& move) {
  return move.sensor.str() + (move.or_sensor.empty() ? "" : " or " + move.or_sensor.str());
}

bool TookPart(const SensorId& sensor, const SessionEstimate& estimate) {
  return estimate.why_not.empty() && std::any_of(estimate.poses.begin(), estimate.poses.end(),
                                                 [&](const RefinedPose& pose) { return pose.sensor == sensor; });
}

// Of sensors that no refinement looked at pairs tell that, and roughly by how much: what was seen after the move is
// fitted with what was seen before.
std::string MoveText(const SensorMovedWithin& move, const SessionEstimate& estimate, const SessionTimes& captured_at) {
  const bool by_refinement =
      TookPart(move.sensor, estimate) && (move.or_sensor.empty() || TookPart(move.or_sensor, estimate));
  const std::string by = by_refinement ? ", by " : ", by roughly ";
  const std::string when = " during the session of " + NameOfSession(estimate.session, captured_at) +
                           ", between captures " + move.last_before.str() + " and " + move.first_after.str();
  if (IsOfLens(move)) return "the lens of " + move.sensor.str() + " changed" + when + ": " + FocalText(*move.lens);
  return EitherOf(move) + " was moved" + when + by + OffText(move.step) +
         (move.lens ? ", or its lens changed (" + FocalText(*move.lens) + ")" : "") +
         (move.or_board.empty() ? "" : ", or board " + move.or_board.str() + " was") +
         (move.or_world_of.empty() ? ""
                                   : ", or " + move.or_world_of.str() + " tells its poses from another origin since");
}

std::string MoveText(const SensorMovedBetween& move, const SessionTimes& captured_at) {
  return move.sensor.str() + " was moved between the sessions of " + NameOfSession(move.last_before, captured_at) +
         " and " + NameOfSession(move.first_after, captured_at) + ", by " + OffText(move.step);
}

void AddOnce(const std::string& name, std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

// Of a tracker whose poses are told against another origin from one capture on.
std::string KeepOrigin(const SensorId& tracker) {
  return "see that " + tracker.str() + " keeps the origin of its poses, and is not started anew, all session long";
}

std::string MoveText(const BoardMovedWithin& moved, const std::string& session) {
  const std::string when = " during the session of " + session + ", between captures " + moved.last_before.str() +
                           " and " + moved.first_after.str() + ", by " + OffText(moved.step);
  if (moved.world_of.empty())
    return "board " + moved.board.str() + (moved.or_board.empty() ? "" : " or board " + moved.or_board.str()) +
           " was moved" + when + ", and its two places are told apart, as far as each was seen";
  return "the poses that " + moved.world_of.str() + " tells jumped" + when +
         ": it tells them from another origin since, and its own place on the robot is not affected" +
         (moved.or_board.empty() ? "" : ", or board " + moved.or_board.str() + " was moved");
}

std::string PushRemounted(const std::vector<std::string>& sensors) {
  std::string flags;
  for (const std::string& name : sensors) flags += (flags.empty() ? "" : ",") + name;
  return "`rigcal push FOLDER --remounted " + flags + "`";
}

// What was measured before it was mended stays wrong, of a mount and of a lens: it has to become past.
std::string CaptureAndPush(const std::vector<std::string>& sensors) {
  return "capture again, then " + PushRemounted(sensors);
}

// The question, and what to do where the answer is yes.
std::string MovedByHand(const std::vector<std::string>& sensors, const SensorMovedBetween& first,
                        const SessionTimes& captured_at) {
  return (sensors.size() == 1 ? "Was " : "Were ") + List(sensors) + " moved after " +
         NameOfSession(first.last_before, captured_at) + "? Yes: " + PushRemounted(sensors) + " of the session of " +
         NameOfSession(first.first_after, captured_at);
}

// Of a lens first: one that is not locked changes again.
std::string CureOf(const std::vector<std::string>& mounts, const std::vector<std::string>& lenses) {
  std::string cure = lenses.empty() ? ""
                                    : "Lock focus and zoom of " + List(lenses) +
                                          ", take new intrinsics or leave them out of session.yaml, ";
  if (!mounts.empty())
    cure += std::string(cure.empty() ? "Tighten" : "tighten") + " the mount of " + List(mounts) + ", ";
  std::vector<std::string> sensors = lenses;
  for (const std::string& name : mounts) AddOnce(name, sensors);
  return cure + CaptureAndPush(sensors);
}

DecidingFigure FigureOf(const SensorMovedWithin& move, const Policy& policy) {
  if (IsOfLens(move)) return {"Lens of " + move.sensor.str() + " changed", FocalText(*move.lens), "during the session"};
  return OffFigure(EitherOf(move) + " moved by", move.step, LimitsOf(policy, move.sensor).moved_min);
}

// Of each sensor the largest difference between two sessions, by its tolerance; the largest of all first.
std::vector<SensorMovedBetween> LargestApart(const GraphSolution& solution, const Policy& policy) {
  const auto times = [&](const SensorMovedBetween& one) {
    return TimesLimit(one.step, LimitsOf(policy, one.sensor).tolerance);
  };
  std::vector<SensorMovedBetween> largest = solution.fused.apart;
  std::stable_sort(largest.begin(), largest.end(),
                   [&](const SensorMovedBetween& x, const SensorMovedBetween& y) { return times(x) > times(y); });
  std::set<SensorId> told;
  std::erase_if(largest, [&](const SensorMovedBetween& one) { return !told.insert(one.sensor).second; });
  return largest;
}

DecidingFigure ApartFigure(const SensorMovedBetween& apart, const Policy& policy) {
  return OffFigure(apart.sensor.str() + " elsewhere by", apart.step, LimitsOf(policy, apart.sensor).tolerance);
}

std::string ApartText(const SensorMovedBetween& apart, const Policy& policy, const SessionTimes& captured_at) {
  const DecidingFigure figure = ApartFigure(apart, policy);
  return apart.sensor.str() + " sat " + figure.value + " elsewhere in the session of " +
         NameOfSession(apart.last_before, captured_at) + " than in that of " +
         NameOfSession(apart.first_after, captured_at) + " (" + figure.limit + ")";
}

// Of more visits what a sensor scatters by is known, and in what is told of its pose.
bool IsOfTwoVisits(const SensorId& sensor, const GraphSolution& solution) {
  for (const SensorPose& pose : solution.poses)
    if (pose.sensor == sensor && pose.fused) return pose.fused->sessions <= 2;
  return solution.fused.sessions.size() <= 2;
}

std::vector<SensorMovedBetween> FarApart(const GraphSolution& solution, const Policy& policy) {
  std::vector<SensorMovedBetween> apart = LargestApart(solution, policy);
  std::erase_if(apart, [&](const SensorMovedBetween& one) {
    return !IsBeyond(one.step, LimitsOf(policy, one.sensor).tolerance);
  });
  return apart;
}

// Of two visits.
std::vector<SensorMovedBetween> LittleApart(const GraphSolution& solution, const Policy& policy) {
  std::vector<SensorMovedBetween> apart = LargestApart(solution, policy);
  std::erase_if(apart, [&](const SensorMovedBetween& one) {
    return IsSmallMove(one, policy) || IsBeyond(one.step, LimitsOf(policy, one.sensor).tolerance) ||
           !IsOfTwoVisits(one.sensor, solution);
  });
  return apart;
}

std::string Within(const std::string& move, const SensorId& sensor, const Policy& policy) {
  return move + ", within " + LimitText(LimitsOf(policy, sensor).moved_min);
}

}  // namespace

std::vector<std::string> KeysOfMoves(const std::vector<SessionEstimate>& estimates, const GraphSolution& solution,
                                     const Policy& policy) {
  std::vector<std::string> keys;
  const auto add = [&](const std::string& key) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  };
  for (const SessionEstimate& estimate : estimates) {
    for (const SensorMovedWithin& move : LargeOnes(estimate.moved, policy))
      if (IsOfLens(move) || move.or_sensor.empty())
        add((IsOfLens(move) ? "lens_changed " : "moved ") + move.sensor.str());
      else
        add("moved " + std::min(move.sensor, move.or_sensor).str() + " " + std::max(move.sensor, move.or_sensor).str());
    if (!keys.empty()) return keys;
  }
  for (const SensorMovedBetween& move : LargeOnes(solution.fused.moved, policy)) add("moved " + move.sensor.str());
  return keys;
}

std::string SmallMoves(const std::vector<SessionEstimate>& estimates, const GraphSolution& solution,
                       const Policy& policy, const SessionTimes& captured_at) {
  for (const SessionEstimate& estimate : estimates)
    for (const SensorMovedWithin& move : estimate.moved)
      if (IsSmallMove(move, policy)) return Within(MoveText(move, estimate, captured_at), move.sensor, policy);
  for (const SensorMovedBetween& move : solution.fused.moved)
    if (IsSmallMove(move, policy)) return Within(MoveText(move, captured_at), move.sensor, policy);
  return "";
}

std::optional<Finding> FindMovedWithin(const std::vector<SessionEstimate>& estimates, const Policy& policy,
                                       const SessionTimes& captured_at) {
  const auto moved = std::find_if(estimates.begin(), estimates.end(),
                                  [&](const auto& one) { return !LargeOnes(one.moved, policy).empty(); });
  if (moved == estimates.end()) return std::nullopt;
  Finding finding;
  std::vector<std::string> mounts, lenses;
  for (const SensorMovedWithin& one : LargeOnes(moved->moved, policy)) {
    finding.why += (finding.why.empty() ? "" : "; ") + MoveText(one, *moved, captured_at);
    if (one.lens) AddOnce(one.sensor.str(), lenses);
    finding.accused.push_back(one.sensor);
    if (finding.figure.name.empty()) finding.figure = FigureOf(one, policy);
    if (IsOfLens(one)) continue;
    for (const std::string& name : MountsOf(one)) AddOnce(name, mounts);
    if (!one.or_sensor.empty()) finding.accused.push_back(one.or_sensor);
  }
  finding.what_to_do = CureOf(mounts, lenses);
  for (const SensorMovedWithin& one : moved->moved)
    if (!one.or_board.empty()) finding.what_to_do += "; if it was board " + one.or_board.str() + ", fasten that";
  for (const SensorMovedWithin& one : moved->moved)
    if (!one.or_world_of.empty()) finding.what_to_do += "; if it was the origin, " + KeepOrigin(one.or_world_of);
  return finding;
}

std::optional<Finding> FindMovedBoards(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at) {
  const auto newest =
      std::find_if(estimates.begin(), estimates.end(), [](const auto& one) { return one.why_not.empty(); });
  if (newest == estimates.end() || newest->boards_moved.empty()) return std::nullopt;
  Finding finding;
  std::vector<std::string> cures;
  for (const BoardMovedWithin& one : newest->boards_moved) {
    finding.why += (finding.why.empty() ? "" : "; ") + MoveText(one, NameOfSession(newest->session, captured_at));
    AddOnce(one.world_of.empty() ? "fasten the board" : KeepOrigin(one.world_of), cures);
  }
  finding.what_to_do = "Before the next session " + List(cures);
  return finding;
}

std::string CureOfOddSession(const SessionId& session, const SessionTimes& captured_at) {
  return ". No: the newer sessions agree without that of " + NameOfSession(session, captured_at) + ", take it out: `" +
         RetireCommand(session) + "`";
}

std::optional<Finding> FindMovedBetween(const GraphSolution& solution, const Policy& policy,
                                        const SessionTimes& captured_at) {
  const std::vector<SensorMovedBetween> moved = LargeOnes(solution.fused.moved, policy);
  if (moved.empty()) return std::nullopt;
  Finding finding;
  std::vector<std::string> names;
  for (const SensorMovedBetween& one : moved) {
    finding.why += (names.empty() ? "" : "; ") + MoveText(one, captured_at);
    AddOnce(one.sensor.str(), names);
    finding.accused.push_back(one.sensor);
  }
  const SensorMovedBetween& first = moved.front();
  finding.figure = OffFigure(first.sensor.str() + " moved by", first.step, LimitsOf(policy, first.sensor).moved_min);
  const std::vector<SessionId>& sessions = solution.fused.sessions;  // the newest first
  const bool is_oldest_odd = sessions.size() > 2 && std::all_of(moved.begin(), moved.end(), [&](const auto& one) {
                               return one.last_before == sessions.back() && !IsOfTwoVisits(one.sensor, solution);
                             });
  finding.what_to_do =
      MovedByHand(names, first, captured_at) + (is_oldest_odd ? CureOfOddSession(first.last_before, captured_at)
                                                              : ". No: tighten the mount, " + CaptureAndPush(names));
  return finding;
}

std::optional<Finding> FindApart(const GraphSolution& solution, const Policy& policy, const SessionTimes& captured_at) {
  const std::vector<SensorMovedBetween> apart = FarApart(solution, policy);
  if (apart.empty()) return std::nullopt;
  Finding finding;
  std::vector<std::string> names;
  for (const SensorMovedBetween& one : apart) {
    finding.why += (names.empty() ? "" : "; ") + ApartText(one, policy, captured_at);
    names.push_back(one.sensor.str());
    finding.accused.push_back(one.sensor);
  }
  const bool is_one = names.size() == 1;
  const SensorMovedBetween& first = apart.front();
  finding.why +=
      std::string(is_one ? ": it was moved, or its mount is loose" : ": they were moved, or their mounts are loose") +
      (IsOfTwoVisits(first.sensor, solution) ? "; two visits cannot tell which" : "; the visits do not tell which");
  finding.figure = ApartFigure(first, policy);
  finding.what_to_do = MovedByHand(names, first, captured_at) + ". No: check " +
                       (is_one ? "its mount. Loose" : "their mounts. Loose") + ": tighten " + (is_one ? "it" : "them") +
                       ", " + CaptureAndPush(names) + ". Firm: push another session";
  return finding;
}

std::string ApartRemark(const GraphSolution& solution, const Policy& policy, const SessionTimes& captured_at) {
  const std::vector<SensorMovedBetween> apart = LittleApart(solution, policy);
  if (apart.empty()) return "";
  const std::size_t others = apart.size() - 1;
  return ApartText(apart.front(), policy, captured_at) +
         (others == 0   ? ""
          : others == 1 ? ", and one other by less"
                        : ", and " + std::to_string(others) + " others by less") +
         ", more than the sessions err by: two visits do not tell whether it was moved or its mount gives";
}

std::vector<SensorMovedBetween> ToldElsewhere(const GraphSolution& solution, const Policy& policy,
                                              const SessionId& newest) {
  std::vector<SensorMovedBetween> told = FarApart(solution, policy);
  for (SensorMovedBetween& one : LittleApart(solution, policy)) told.push_back(std::move(one));
  for (SensorMovedBetween& one : LargeOnes(solution.fused.moved, policy))
    if (one.first_after == newest) told.push_back(std::move(one));
  return told;
}

std::optional<Finding> FindHeldBack(const GraphSolution& solution, const SessionHeaders& headers) {
  const FusedSessions& fused = solution.fused;
  const auto newest = fused.sessions.empty() ? headers.end() : headers.find(fused.sessions.front());
  if (newest == headers.end()) return std::nullopt;
  std::map<std::pair<SensorId, SensorId>, std::set<std::string>> captures;
  std::set<SensorId> sensors;
  for (const FusedSessions::HeldBack& look : fused.held_back) {
    const Sensor* sensor = rigcal::SensorOf(newest->second, look.sensor);
    if (look.session != newest->first || sensor == nullptr || sensor->kind != SensorKind::kCamera ||
        look.why != WhyHeldBack::kContradicts)
      continue;
    captures[{look.sensor, look.against}].insert(look.capture.str());
    sensors.insert(look.sensor);
  }
  if (captures.empty()) return std::nullopt;
  Finding finding;
  for (const auto& [who, names] : captures) {
    const std::vector<std::string> saw(names.begin(), names.end());
    const std::string against = who.second.empty() ? "the rest" : who.second.str();
    finding.why += (finding.why.empty() ? "" : "; ") + std::string("what ") + who.first.str() + " saw in capture " +
                   List(saw) + " contradicts " + against + " and was left out";
  }
  const std::vector<SensorId> all(sensors.begin(), sensors.end());
  finding.accused = all;
  finding.what_to_do = "Check that " + List(all) + " and the others take their pictures at the same moment";
  return finding;
}

}  // namespace rigcal::fleet

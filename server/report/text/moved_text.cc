#include "server/report/text/moved_text.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "server/report/text/figure_words.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::string HowFar(const SensorMove& move) {
  return Significant(move.distance_m * kMmPerMetre, 2) + " mm and " + Significant(move.angle_rad * kDegPerRad, 2) +
         " deg (" + SigmasText(move.in_sigmas) + " \xCF\x83)";
}

// The farthest of all in mm and in deg need not be one sensor.
std::string NothingMoved(const Changes& changes) {
  SensorMove most = changes.moves.front();
  for (const SensorMove& move : changes.moves) {
    most.distance_m = std::max(most.distance_m, move.distance_m);
    most.angle_rad = std::max(most.angle_rad, move.angle_rad);
  }
  return "Nothing moved: " + std::string(changes.moves.size() == 1 ? "the one sensor is" : "every sensor is") +
         " where it was, to within " + HowFar(most) + ".";
}

std::string OthersText(const Changes& changes, std::size_t moved) {
  if (moved == changes.moves.size()) return "";
  const std::size_t others = changes.moves.size() - moved;
  return (others == 1 ? " The other one is where it was"
                      : " The other " + std::to_string(others) + " are where they were") +
         ", to within " + SigmasText(changes.moves[moved].in_sigmas) + " \xCF\x83.";
}

// The sensor that all of them have in common; empty if there is none, or if it could be either of two.
SensorId CommonSensor(const std::vector<const EdgeMove*>& off) {
  std::set<SensorId> common = {off.front()->now->frame_a, off.front()->now->frame_b};
  for (const EdgeMove* move : off)
    for (auto sensor = common.begin(); sensor != common.end();)
      sensor =
          *sensor == move->now->frame_a || *sensor == move->now->frame_b ? std::next(sensor) : common.erase(sensor);
  return common.size() == 1 ? *common.begin() : SensorId();
}

// A pose that was polished, beside one that was not.
std::string OtherwiseText(const EdgeMove& move) {
  const std::string before = MethodText(*move.before), now = MethodText(*move.now);
  return before == now
             ? ""
             : " It was found otherwise than before (" + before + " \xE2\x86\x92 " + now + "), which may be why.";
}

}  // namespace

std::string WhatMeasured(const std::vector<EdgeMove>& moves) {
  std::vector<const EdgeMove*> off;
  for (const EdgeMove& move : moves)
    if (move.measured_again && move.in_sigmas >= kOff_sigmas) off.push_back(&move);
  if (off.empty()) return "";
  const EdgeMove& most = *off.front();
  const std::string text = "Measured anew, " + most.now->frame_a.str() + " \xE2\x86\x92 " + most.now->frame_b.str() +
                           " is off by " + Significant(most.d.head<3>().norm() * kMmPerMetre, 2) + " mm and " +
                           Significant(most.d.tail<3>().norm() * kDegPerRad, 2) + " deg (" +
                           SigmasText(most.in_sigmas) + " \xCF\x83)." + OtherwiseText(most);
  const SensorId common = CommonSensor(off);
  if (off.size() < 2 || common.empty()) return text;
  return text + " All " + std::to_string(off.size()) + " pairs that are off have " + common.str() + " in common.";
}

std::string WhatWasNotMeasured(const Changes& changes, const std::vector<EdgeMove>& edges) {
  constexpr std::size_t kNamedMax = 4;
  std::set<SensorId> measured;
  for (const EdgeMove& edge : edges)
    if (edge.now != nullptr && (edge.measured_again || edge.before == nullptr))
      measured.insert({edge.now->frame_a, edge.now->frame_b});
  if (measured.empty()) return "No pair was measured anew: what moved meanwhile is not known.";
  std::vector<std::string> names;
  for (const SensorMove& move : changes.moves)
    if (move.in_sigmas < kOff_sigmas && !measured.contains(move.sensor)) names.push_back(move.sensor.str());
  if (names.empty()) return "";
  std::string text = names.front();
  for (std::size_t i = 1; i < std::min(names.size(), kNamedMax); ++i) text += ", " + names[i];
  if (names.size() > kNamedMax) text += " and " + std::to_string(names.size() - kNamedMax) + " more";
  return text + (names.size() == 1 ? " was not measured anew: whether it moved is not known."
                                   : " were not measured anew: whether they moved is not known.");
}

MovedText WhatMoved(const Changes& changes, const SensorId& reference) {
  if (!changes.same_reference)
    return {"The two revisions have different reference sensors: poses are not compared.", false};
  if (changes.moves.empty()) return {"No sensor but the reference is known in both revisions.", false};
  const auto moved =
      static_cast<std::size_t>(std::count_if(changes.moves.begin(), changes.moves.end(),
                                             [](const SensorMove& move) { return move.in_sigmas >= kOff_sigmas; }));
  if (moved == 0) return {NothingMoved(changes), false};
  const SensorMove& most = changes.moves.front();
  if (moved == 1) return {most.sensor.str() + " moved by " + HowFar(most) + "." + OthersText(changes, moved), true};
  std::string text = std::to_string(moved) + " of " + std::to_string(changes.moves.size()) +
                     " sensors moved, most of all " + most.sensor.str() + ", by " + HowFar(most) + "." +
                     OthersText(changes, moved);
  if (moved == changes.moves.size())
    text += " Where all move against " + reference.str() + ", look first whether " + reference.str() + " itself moved.";
  return {text, true};
}

}  // namespace rigcal::report

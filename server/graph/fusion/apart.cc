// Who sat elsewhere on another visit, as a mount may have it.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <iterator>

#include "server/graph/fusion/visit_sides.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"

namespace rigcal::graph {
namespace {

// What is left to explain where this one may be anywhere.
void TakeOut(const SensorId& sensor, const SensorId& reference, Difference& difference) {
  if (sensor == reference) {
    const Eigen::MatrixXd by_reference = ByReference(difference);
    difference.S += by_reference * by_reference.transpose();  // 1 m and 1 rad
    return;
  }
  Difference left;
  std::vector<int> rows;
  for (std::size_t s = 0; s < difference.sensors.size(); ++s) {
    if (difference.sensors[s] == sensor) continue;
    left.sensors.push_back(difference.sensors[s]);
    left.T_before.push_back(difference.T_before[s]);
    for (int i = 0; i < 6; ++i) rows.push_back(static_cast<int>(6 * s) + i);
  }
  left.d = difference.d(rows);
  left.S = difference.S(rows, rows);
  difference = std::move(left);
}

// Of a step what is beyond chance by what both sessions err by, axis by axis: along one that is known badly nothing is
// told.
Vector6d BeyondChance(const Vector6d& step, const Change& by_own) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(by_own.covariance);
  Vector6d told = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6d axis = axes.eigenvectors().col(i);
    const double off = axis.dot(by_own.step), variance = std::max(0.0, axes.eigenvalues()[i]);
    if (off * off >= kMovedMinSigmas * kMovedMinSigmas * variance) told += axis * axis.dot(step);
  }
  return told;
}

// What two sessions have elsewhere, as long as what both err by does not explain the rest. Who it is, and by how much,
// is told as mounts go that scatter: else one that is known surely takes up what the others scatter by. `pairs`: how
// many such are looked at.
std::vector<SensorMovedBetween> ApartIn(const FusionInput& input, const Visits& two, std::size_t pairs,
                                        const SensorsOfSessions& left_out) {
  std::vector<SensorMovedBetween> apart;
  auto both = SidesAbout(input, two, 1, left_out);
  auto of_sound = both ? DifferenceOfSoundMounts(both->sides) : std::nullopt;
  if (!of_sound) return apart;
  Difference& own = both->difference;
  const auto is_beyond_chance = [&](const Change& by_own) {
    const double odds = std::min(1.0, both->sensors_asked * static_cast<double>(pairs) * ChiSquareTail(by_own.gain, 6));
    return IsMove(by_own.step, Observable(by_own.covariance).covariance, odds);
  };
  const std::size_t rounds = own.sensors.size() + 1;
  for (std::size_t round = 0; round < rounds && !own.sensors.empty(); ++round) {
    if (!is_beyond_chance(LikeliestChange(own, input.reference))) break;
    const Change change = LikeliestChange(*of_sound, input.reference);
    // One that is known too little to tell may be what explains most of what the others scatter by.
    for (const Change& by_own : ChangesOf(own, input.reference))
      if (by_own.sensor == change.sensor && is_beyond_chance(by_own) && static_cast<int>(apart.size()) < kMovesMax)
        apart.push_back(
            {change.sensor, two.sessions[0].session, two.sessions[1].session, BeyondChance(change.step, by_own),
             std::min(1.0, both->sensors_asked * static_cast<double>(pairs) * ChiSquareTail(by_own.gain, 6))});
    for (Difference* one : {&own, &*of_sound}) TakeOut(change.sensor, input.reference, *one);
  }
  return apart;
}

// Two sessions in the frame of the reference, or of a sensor that both tell where one does not tell it: an island, or a
// session of before it was remounted. None: nothing can be held against each other.
std::optional<SensorId> FrameOfBoth(const std::set<SensorId>& x, const std::set<SensorId>& y,
                                    const SensorId& reference) {
  if (x.contains(reference) && y.contains(reference)) return reference;
  std::vector<SensorId> both;
  std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
  return both.size() < 2 ? std::nullopt : std::optional(both.front());
}

}  // namespace

// Each sensor is where the newest session that tells of it has it: what older ones are apart from that is looked for.
std::vector<SensorMovedBetween> FindApart(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                          const SensorsOfSessions& left_out) {
  std::vector<SensorMovedBetween> apart;
  std::set<SensorId> told;
  for (std::size_t newer = oldest_first.size(); newer-- > 1;) {
    const std::set<SensorId> tells = SensorsTold(input, oldest_first[newer], left_out);
    if (std::includes(told.begin(), told.end(), tells.begin(), tells.end())) continue;
    for (std::size_t older = newer; older-- > 0;) {
      const Visits two{{oldest_first[older], oldest_first[newer]},
                       {SensorsTold(input, oldest_first[older], left_out), tells}};
      const auto frame = FrameOfBoth(two.told[0], two.told[1], input.reference);
      if (!frame) continue;
      const GraphSolution start = *frame == input.reference ? input.start : InFrameOf(*frame, input.start);
      for (SensorMovedBetween& one :
           ApartIn({input.edges, input.within, *frame, start}, two, oldest_first.size() - 1, left_out))
        if (!told.contains(one.sensor)) apart.push_back(std::move(one));
    }
    told.insert(tells.begin(), tells.end());
  }
  return apart;
}

}  // namespace rigcal::graph

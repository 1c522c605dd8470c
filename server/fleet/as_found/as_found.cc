#include "server/fleet/as_found/as_found.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/fleet/as_found/change_seen.h"
#include "server/fleet/as_found/one_visit_scatter.h"
#include "server/fleet/as_found/smallest_change.h"

namespace rigcal::fleet {
namespace {

using Eigen::Index;

constexpr std::size_t kMoversMax = 8;
bool IsAxisBeyond(const ChangeSeen& seen, Index row, double alpha_of_axis) {
  return seen.IsMeasured(row) &&
         std::abs(seen.change(row)) >
             LimitInSigmas(alpha_of_axis, seen.dof[static_cast<std::size_t>(row)]) * seen.Sigma(row);
}

int MeasuredAxes(const ChangeSeen& seen) {
  int measured = 0;
  for (Index row = 0; row < seen.change.size(); ++row) measured += seen.IsMeasured(row) ? 1 : 0;
  return measured;
}

bool AnyBeyond(const ChangeSeen& seen, double alpha_of_axis) {
  for (Index row = 0; row < seen.change.size(); ++row)
    if (IsAxisBeyond(seen, row, alpha_of_axis)) return true;
  return false;
}

std::vector<SensorId> AllBut(std::vector<SensorId> sensors, const SensorId& one) {
  std::erase(sensors, one);
  return sensors;
}

// In use and in the session, and not moved by anybody who said so. Sorted.
std::vector<SensorId> ToTest(const AsFoundInput& input) {
  std::vector<SensorId> sensors;
  for (const KnownPose& pose : input.session.poses)
    if (input.in_use.Find(pose.sensor) != nullptr && !input.moved_on_purpose.contains(pose.sensor))
      sensors.push_back(pose.sensor);
  std::sort(sensors.begin(), sensors.end());
  return sensors;
}

SensorId FirstFrame(const AsFoundInput& input, const std::vector<SensorId>& sensors) {
  for (const SensorId& reference : {input.in_use.reference, input.session.reference})
    if (std::find(sensors.begin(), sensors.end(), reference) != sensors.end()) return reference;
  return sensors.size() > 1 ? sensors.front() : input.in_use.reference;
}

// The sensor whose shifts against the frame are known best.
SensorId BestKnown(const ChangeSeen& seen) {
  const auto variance_m2 = [&](std::size_t s) {
    return seen.covariance.diagonal().segment<3>(static_cast<Index>(6 * s)).sum();
  };
  std::size_t best = 0;
  for (std::size_t s = 1; s < seen.sensors.size(); ++s)
    if (variance_m2(s) < variance_m2(best)) best = s;
  return seen.sensors[best];
}

struct Search {
  SensorId frame;             // did not move
  std::vector<Mover> movers;  // the likeliest first
  int tests = 0;
  double alpha_of_axis = 0.0;
};

// As long as something has changed beyond the limit, the sensor that explains it best is taken out of what stands
// still. `axes_of_parts`: that are tested besides, and share the odds.
Search FindMovers(const AsFoundInput& input, std::vector<SensorId> still, int axes_of_parts) {
  Search search{FirstFrame(input, still), {}, axes_of_parts, 0.0};
  if (still.size() > 1)
    search.tests += MeasuredAxes(ChangeBetween(search.frame, AllBut(still, search.frame), input.in_use, input.session));
  search.alpha_of_axis = (1 - kAlphaOfRates) * input.alpha / std::max(1, search.tests);
  while (still.size() > 1 && search.movers.size() < kMoversMax) {
    const ChangeSeen seen = ChangeBetween(search.frame, AllBut(still, search.frame), input.in_use, input.session);
    if (!AnyBeyond(seen, search.alpha_of_axis)) break;
    const Mover mover = LikeliestMover(seen);
    if (mover.sensor == search.frame) search.frame = BestKnown(seen);
    still = AllBut(still, mover.sensor);
    search.movers.push_back(mover);
  }
  return search;
}

// Who was moved on purpose, or against whom nothing is told, is not among them.
std::vector<PartOfBoth> PartsToTest(const AsFoundInput& input, const std::vector<SensorId>& whole) {
  std::vector<PartOfBoth> parts;
  if (input.moved_on_purpose.contains(input.in_use.reference)) return parts;
  for (const PartOfBoth& part : input.parts)
    if (!input.moved_on_purpose.contains(part.session.sensor) &&
        std::find(whole.begin(), whole.end(), part.session.sensor) == whole.end())
      parts.push_back(part);
  return parts;
}

// Nothing where either side does not tell it from the reference in use.
std::optional<FrameOfBoth> FrameAt(const SensorId& frame, const AsFoundInput& input) {
  const SensorId& reference = input.in_use.reference;
  FrameOfBoth both{frame, {}, {}};
  if (frame == reference) return both;
  const auto in_use = PlaceIn(reference, frame, input.in_use), session = PlaceIn(reference, frame, input.session);
  if (!in_use || !session) return std::nullopt;
  both.T_ref_in_use = *in_use, both.T_ref_session = *session;
  both.covariance_in_use = SeenFrom(reference, {frame}, input.in_use).covariance;
  both.covariance_session = SeenFrom(reference, {frame}, input.session).covariance;
  return both;
}

// Of each part that can be seen from the sensor.
std::vector<ChangeSeen> ChangesOfParts(const AsFoundInput& input, const std::vector<PartOfBoth>& parts,
                                       const SensorId& frame) {
  std::vector<ChangeSeen> changes;
  const auto seen_from = FrameAt(frame, input);
  for (const PartOfBoth& part : parts)
    if (auto seen = seen_from ? ChangeOfPart(part, *seen_from, input.assumed_scatter) : std::nullopt)
      changes.push_back(std::move(*seen));
  return changes;
}

int MeasuredAxesOf(const std::vector<ChangeSeen>& changes) {
  int measured = 0;
  for (const ChangeSeen& seen : changes) measured += MeasuredAxes(seen);
  return measured;
}

// `still`: did not move.
void FillAxes(const ChangeSeen& seen, std::size_t s, const std::vector<SensorId>& still, double alpha_of_axis,
              SensorFound& found) {
  for (int axis = 0; axis < 6; ++axis) {
    const auto row = static_cast<Index>(6 * s) + axis;
    if (!seen.IsMeasured(row)) continue;
    found.change(axis) = seen.change(row);
    found.sigma(axis) = seen.Sigma(row);
    found.smallest(axis) = SmallestChange(seen, row, still, alpha_of_axis);
    const bool beyond = IsAxisBeyond(seen, row, alpha_of_axis);
    found.axes[static_cast<std::size_t>(axis)] = beyond ? FoundState::kDrifted : FoundState::kUnchanged;
    if (found.state != FoundState::kDrifted) found.state = found.axes[static_cast<std::size_t>(axis)];
  }
}

std::optional<Vector6d> LeftOf(const SensorId& sensor, const SensorId& frame, const AsFoundInput& input) {
  const auto left = PlaceIn(frame, sensor, input.left), is = PlaceIn(frame, sensor, input.session);
  if (!left || !is) return std::nullopt;
  return (left->Inverse() * *is).Log();
}

std::vector<SensorFound> Tested(const AsFoundInput& input, const std::vector<SensorId>& sensors, const Search& search) {
  const ChangeSeen seen = ChangeBetween(search.frame, AllBut(sensors, search.frame), input.in_use, input.session);
  std::vector<SensorId> still = sensors;
  for (const Mover& mover : search.movers) std::erase(still, mover.sensor);
  std::vector<SensorFound> tested;
  for (std::size_t s = 0; s < seen.sensors.size(); ++s) {
    SensorFound found;
    found.sensor = seen.sensors[s];
    FillAxes(seen, s, still, search.alpha_of_axis, found);
    for (const Mover& mover : search.movers)
      if (mover.sensor == found.sensor) found.state = FoundState::kDrifted, found.or_else = mover.or_else;
    found.left = LeftOf(found.sensor, search.frame, input);
    tested.push_back(std::move(found));
  }
  return tested;
}

// `alone`: nobody vouches for the sensor from which they are seen.
std::vector<SensorFound> TestedParts(const std::vector<ChangeSeen>& changes, bool alone, const Search& search) {
  std::vector<SensorFound> tested;
  for (const ChangeSeen& seen : changes) {
    SensorFound found;
    found.sensor = seen.sensors.front();
    FillAxes(seen, 0, {}, search.alpha_of_axis, found);
    if (alone && found.state == FoundState::kDrifted) found.or_else = seen.frame;
    tested.push_back(std::move(found));
  }
  return tested;
}

// Of sensors that are not tested, but for the one from which they are seen.
std::vector<SensorFound> Untested(const AsFoundInput& input, const std::vector<SensorFound>& tested,
                                  const SensorId& frame) {
  std::set<SensorId> sensors;
  for (const KnownPoses* poses : {&input.in_use, &input.session})
    for (const KnownPose& pose : poses->poses) sensors.insert(pose.sensor);
  std::set<SensorId> in_part;
  for (const PartOfBoth& part : input.parts) in_part.insert(part.session.sensor);
  sensors.insert(in_part.begin(), in_part.end());
  for (const SensorFound& one : tested) sensors.erase(one.sensor);
  sensors.erase(frame);
  std::vector<SensorFound> untested;
  for (const SensorId& sensor : sensors) {
    SensorFound found;
    found.sensor = sensor;
    if (input.moved_on_purpose.contains(sensor))
      found.state = FoundState::kMovedOnPurpose;
    else if (input.in_use.Find(sensor) == nullptr && !in_part.contains(sensor))
      found.state = FoundState::kNew;
    untested.push_back(std::move(found));
  }
  return untested;
}

int FewestVisits(const AsFoundInput& input, const std::vector<SensorId>& sensors) {
  std::optional<int> fewest;
  for (const SensorId& sensor : AllBut(sensors, input.in_use.reference))
    fewest = std::min(fewest.value_or(input.in_use.Find(sensor)->visits), input.in_use.Find(sensor)->visits);
  return fewest.value_or(0);
}

int FewestRobots(const AsFoundInput& input, const std::vector<SensorId>& sensors) {
  std::optional<int> fewest;
  for (const SensorId& sensor : AllBut(sensors, input.in_use.reference)) {
    const int robots = input.in_use.Find(sensor)->scatter_robots;
    fewest = std::min(fewest.value_or(robots), robots);
  }
  return fewest.value_or(0);
}

}  // namespace

AsFound TestAsFound(const AsFoundInput& told) {
  AsFoundInput input = told;
  input.in_use = WithScatter(std::move(input.in_use), told);
  AsFound found;
  found.alpha = input.alpha;
  const std::vector<SensorId> sensors = ToTest(input);
  const std::vector<PartOfBoth> parts = PartsToTest(input, sensors);
  if (sensors.size() < 2 && parts.empty()) {
    found.sensors = Untested(input, {}, sensors.empty() ? SensorId() : sensors.front());
    found.why_not = "The session tells no two sensors against each other that were in use and stayed where they were.";
    return found;
  }
  const int axes_of_parts = MeasuredAxesOf(ChangesOfParts(input, parts, FirstFrame(input, sensors)));
  const Search search = FindMovers(input, sensors, axes_of_parts);
  // Nobody else vouches for the frame.
  const bool is_alone = sensors.size() < 2 + search.movers.size();
  std::vector<SensorFound> tested = TestedParts(ChangesOfParts(input, parts, search.frame), is_alone, search);
  if (sensors.size() > 1) {
    std::vector<SensorFound> whole = Tested(input, sensors, search);
    std::move(whole.begin(), whole.end(), std::back_inserter(tested));
  }
  found.sensors = Untested(input, tested, search.frame);
  std::move(tested.begin(), tested.end(), std::back_inserter(found.sensors));
  std::sort(found.sensors.begin(), found.sensors.end(),
            [](const auto& x, const auto& y) { return x.sensor < y.sensor; });
  found.tests = search.tests;
  found.visits = FewestVisits(input, sensors);
  found.scatter_robots = FewestRobots(input, sensors);
  found.relative_to = search.frame;
  if (found.tests == 0) found.why_not = "The session measured no axis of the sensors that were in use.";
  return found;
}

}  // namespace rigcal::fleet

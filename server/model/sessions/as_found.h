// As found: what a session says of the calibration that was in use when it came, before poses were updated by it. As
// left: what is off after that.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/stamp.h"
#include "server/math/tangent.h"

namespace rigcal {

// Odds of one false alarm or more in a session, over all its sensors and axes together.
constexpr double kAsFoundAlpha = 1e-3;
// With which the smallest change is told that the session could have seen.
constexpr double kAsFoundPower = 0.95;

// Of a sensor, and of each of its axes. Sensors that were moved on purpose or are new are not tested.
// kNotToldApart: the test accuses nobody, though the findings of the same revision tell that it sat elsewhere.
enum class FoundState { kUnchanged, kDrifted, kNotToldApart, kNotMeasured, kMovedOnPurpose, kNew };
// "unchanged", "drifted", "not_told_apart", "not_measured", "moved_on_purpose", "new"; and back, kInvalidInput for any
// other name.
[[nodiscard]] std::string NameOf(FoundState state);
[[nodiscard]] Result<FoundState> FoundStateOf(const std::string& name);

// By how much a sensor's place goes on changing, over the visits that are kept: right tangent at the sensor, m and rad.
struct DriftRate {
  int visits = 0;
  Stamp first, last;
  Vector6d per_30_days = Vector6d::Zero(), sigma_per_30_days = Vector6d::Zero();
};

struct SensorFound {
  SensorId sensor;
  FoundState state = FoundState::kNotMeasured;
  SensorId or_else = {};  // of a drifted one: this one may have moved instead, data tell only one against the other
  std::array<FoundState, 6> axes = {FoundState::kNotMeasured, FoundState::kNotMeasured, FoundState::kNotMeasured,
                                    FoundState::kNotMeasured, FoundState::kNotMeasured, FoundState::kNotMeasured};
  // T_session = T_in_use Exp(change) in the frame of AsFound::relative_to, right tangent at the sensor, m and rad. Of
  // axes that were tested; the others have zeros.
  Vector6d change = Vector6d::Zero(), sigma = Vector6d::Zero();
  Vector6d smallest = Vector6d::Zero();  // change that would have been told with kAsFoundPower; infinite: none would
  std::optional<Vector6d> left = {};     // T_session = T_as_left Exp(left); nothing: it has no pose any more
  std::optional<DriftRate> rate = {};    // from three visits on
  // Of one that is not told apart: by what the findings have it elsewhere, right tangent at the sensor, m and rad.
  // Nothing where it is relative_to that they have elsewhere.
  std::optional<Vector6d> elsewhere = {};
};
// Its place was held against the one in use.
[[nodiscard]] bool IsTested(const SensorFound& sensor);
// Of an axis, 0 to 5: it was tested and has numbers.
[[nodiscard]] bool IsMeasured(const SensorFound& sensor, int axis);
// Of each axis that was tested there is a change that would have been told: else "unchanged" says nothing.
[[nodiscard]] bool CouldTell(const SensorFound& sensor);
// Its state for people: "unchanged", "drifted", "cannot tell" of an unchanged one that could not tell, "not measured",
// "not told apart from scatter".
[[nodiscard]] std::string WordFor(const SensorFound& sensor);
// Largest of |change| / sigma, 0 where nothing is measured.
[[nodiscard]] double InSigmas(const SensorFound& sensor);

struct AsFound {
  SessionId session;
  Stamp captured_at;
  int in_use = 0;                // number of the revision that was in use; 0: none was
  std::optional<Stamp> made_at;  // when that was made
  std::string why_not = {};      // a sentence: nothing was tested; then only what is above has a meaning
  double alpha = kAsFoundAlpha;
  int tests = 0;                           // axes that were tested, in all
  int visits = 0;                          // the fewest, over its sensors, that stand behind what visits scatter by
  int scatter_robots = 0;                  // likewise, other robots of its rig model that stand behind that besides
  SensorId relative_to = {};               // did not move: the others are told in its frame
  std::optional<Vector6d> elsewhere = {};  // SensorFound::elsewhere of relative_to
  std::vector<SensorFound> sensors = {};   // the other ones, sorted
  std::string text = {};                   // all of it in a sentence
};
// Drifted if any sensor is; unchanged if one was tested and could tell, and each is told apart; else not measured.
[[nodiscard]] FoundState StateOf(const AsFound& found);
// The largest `smallest` that any tested sensor's axes have, of the three shifts and the three turns.
[[nodiscard]] double SmallestSeen_m(const AsFound& found);
[[nodiscard]] double SmallestSeen_rad(const AsFound& found);

// At a glance.
struct AsFoundSummary {
  SessionId session;
  FoundState state = FoundState::kNotMeasured;
  std::vector<SensorId> drifted;  // sorted
};
// What lists show of it.
[[nodiscard]] AsFoundSummary SummaryOf(const AsFound& found);

}  // namespace rigcal

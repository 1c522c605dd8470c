#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "client/check/advice.h"
#include "client/check/words.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/calib/core/wording.h"
#include "server/model/approval/policy.h"

namespace rigcal::check {
namespace {

// Before "in 5 different captures".
const char* SeenTogether(Method method) {
  switch (method) {
    case Method::kStereo:
      return "both see the board";
    case Method::kNonOverlapping:
      return "each sees its board";
    case Method::kTrackerCamera:
    case Method::kEyeToHand:
      return "there is a pose, and the board in the picture";
    case Method::kLidarCamera:
      return "there is a cloud, and the board in the picture";
    case Method::kLidarLidar:
      return "both have a cloud";
    case Method::kTrackerLidar:
      return "there are a pose and a cloud";
    case Method::kPoseStreams:
      return "both have a pose";
  }
  return "both see something";
}

std::string CountedText(const PairFound& pair, std::size_t more) {
  const std::string captures = pair.both == 0 ? "no capture" : calib::CountText(pair.both, "different capture");
  const bool drives = RowOf(pair.method).board_stands_still;
  const char* const body = pair.method == Method::kEyeToHand ? "flange" : "robot";
  return std::string(SeenTogether(pair.method)) + " in " + captures + ", " + std::to_string(pair.both + more) +
         " are wanted: take " + std::to_string(more) + " more" +
         (drives ? std::string(" from other places, the ") + body + " turned otherwise" : "");
}

std::optional<Advice> TooFew(const Findings& findings, const PairFound& pair) {
  if (pair.both >= pair.needed.enough) return std::nullopt;
  const std::size_t more = CapturesMore(findings, pair.both);
  return Advice{{PairText(pair.pair)},
                CountedText(pair, more),
                pair.both < pair.needed.least ? Urgency::kNoAnswer : Urgency::kFew,
                more};
}

std::optional<Advice> NoAnswer(const PairFound& pair) {
  const bool failed = pair.edge && pair.edge->state == EdgeState::kFailed;
  if (!pair.problem && !failed) return std::nullopt;
  if (failed && pair.edge->diagnoses.empty()) return Advice{{PairText(pair.pair)}, "it fails", Urgency::kNoAnswer, 0};
  return Advice{{PairText(pair.pair)},
                SentenceOf(pair.problem ? *pair.problem : pair.edge->diagnoses.front()),
                Urgency::kNoAnswer,
                0};
}

// The largest of three axes.
double LargestSigma(const Edge& edge, int first_axis) {
  double largest = 0;
  for (int axis = first_axis; axis < first_axis + 3; ++axis)
    largest = std::max(largest, SigmaOf(edge.uncertainty, axis).value);
  return largest;
}

// Sigma falls with the root of the captures.
std::optional<Advice> TooRough(const PairFound& pair) {
  if (pair.method != Method::kStereo || !pair.IsWhole()) return std::nullopt;
  const double sigma_m = LargestSigma(*pair.edge, 0), sigma_rad = LargestSigma(*pair.edge, 3);
  const double excess = std::max(sigma_m / kDefaultTolerance.m, sigma_rad / kDefaultTolerance.rad);
  if (!(excess > 1)) return std::nullopt;
  const double more = std::ceil(static_cast<double>(pair.both) * std::min(excess * excess - 1, 1.0));
  return Advice{{PairText(pair.pair)},
                "known to " + client::Fixed(client::kMmPerM * sigma_m, 1) + " mm and " +
                    client::Fixed(client::kDegPerRad * sigma_rad, 2) + " deg only, " + DefaultLimitsText() +
                    " are wanted: hold the board nearer, tilted to all sides, in all parts of both pictures",
                Urgency::kRough,
                static_cast<std::size_t>(more)};
}

// Sensors that pairs known whole tie together have one number. `counted`: also those that were only counted.
using Groups = std::map<SensorId, int>;
Groups TiedTogether(const Findings& findings, bool counted) {
  Groups group;
  for (const SensorFiles& files : findings.sensors) group.emplace(files.sensor, static_cast<int>(group.size()));
  for (const PairFound& pair : findings.pairs) {
    if (!pair.IsWhole() || (!counted && !pair.edge)) continue;
    const int kept = group.at(pair.pair.a), gone = group.at(pair.pair.b);
    for (auto& [sensor, number] : group)
      if (number == gone) number = kept;
  }
  return group;
}

bool AreTied(const PairFound& pair, const Groups& group) { return group.at(pair.pair.a) == group.at(pair.pair.b); }

// What a note says of a motion, without the axis: every pair has its own of the same.
std::string OpenText(const Diagnosis& note) {
  struct Motion {
    const char *code, *text;
  };
  static constexpr std::array kMotions = {
      Motion{"planar_motion", "turned about one axis only: how far they are from each other along it is not known"},
      Motion{
          "turning_on_the_spot",
          "turned about one fixed line only: where they are along it, and how they are turned about it, is not known"},
      Motion{"pure_translation", "moved but not turned: where they are from each other is not known"},
      Motion{"straight_line",
             "moved along one line only and not turned: where they are from each other is not known, nor how they are "
             "turned about it"}};
  for (const Motion& motion : kMotions)
    if (note.code == motion.code) return std::string(motion.text) + ". " + note.cure;
  return SentenceOf(note);
}

// A direction stays open that no other pair closes.
std::optional<Advice> OpenMotion(const PairFound& pair, const Groups& group) {
  if (!pair.edge || pair.edge->state == EdgeState::kFailed || pair.IsWhole()) return std::nullopt;
  if (AreTied(pair, group) || pair.edge->diagnoses.empty()) return std::nullopt;
  return Advice{{PairText(pair.pair)}, OpenText(pair.edge->diagnoses.front()), Urgency::kRough, 0};
}

// Two that never see the board together, while others tie them: nothing that more captures need mend.
bool IsNeverTogether(const PairFound& pair, const Groups& group) {
  return pair.both == 0 && pair.needed.least > 0 && !pair.IsWhole() && AreTied(pair, group);
}

// Blurred pictures and open sides do not keep a pair from being judged by itself.
bool IsExplained(const PairFound& pair, const Advice& advice, const std::vector<Advice>& of_sensors) {
  return std::any_of(of_sensors.begin(), of_sensors.end(), [&](const Advice& of_sensor) {
    const bool is_end = std::any_of(of_sensor.of.begin(), of_sensor.of.end(), [&](const std::string& name) {
      return name == pair.pair.a.str() || name == pair.pair.b.str();
    });
    if (!is_end || of_sensor.urgency == Urgency::kRough) return false;
    if (of_sensor.files_lacking > 0 && of_sensor.urgency == Urgency::kFew)  // what these files may make up for
      return advice.captures_more > 0 && advice.captures_more <= of_sensor.files_lacking;
    return of_sensor.urgency == Urgency::kNoAnswer || of_sensor.captures_more == 0 ||
           (advice.urgency <= of_sensor.urgency && advice.captures_more <= of_sensor.captures_more);
  });
}

std::optional<Advice> AdviceOn(const Findings& findings, const PairFound& pair, const Groups& group) {
  if (IsNeverTogether(pair, group)) return std::nullopt;
  std::optional<Advice> advice = TooFew(findings, pair);
  if (!advice) advice = NoAnswer(pair);
  if (!advice) advice = TooRough(pair);
  if (!advice) advice = OpenMotion(pair, group);
  return advice;
}

// The server warns of it, whatever the number of captures.
std::optional<std::string> Unchecked(const Findings& findings) {
  std::vector<std::string> names;
  std::size_t whole = 0;
  for (const PairFound& pair : findings.pairs) {
    if (!pair.IsWhole()) continue;
    ++whole;
    if (!pair.is_checked) names.push_back(PairText(pair.pair));
  }
  if (names.empty()) return std::nullopt;
  return (names.size() == whole ? "No loop of pairs checks the result"
                                : "No loop of pairs checks " + NamesText(names)) +
         ": more captures do not change that. Unless older sessions of the robot check it, a push warns of it: let one "
         "more pair of sensors see the board.";
}

}  // namespace

std::vector<Advice> PairAdvice(const Findings& findings, const std::vector<Advice>& of_sensors) {
  const Groups group = TiedTogether(findings, true);
  std::vector<Advice> all;
  for (const PairFound& pair : findings.pairs)
    if (auto advice = AdviceOn(findings, pair, group); advice && !IsExplained(pair, *advice, of_sensors))
      all.push_back(std::move(*advice));
  return all;
}

std::vector<std::string> PairRemarks(const Findings& findings) {
  const Groups looked_at = TiedTogether(findings, false), group = TiedTogether(findings, true);
  std::vector<std::string> remarks;
  for (const PairFound& pair : findings.pairs) {
    const std::string name = PairText(pair.pair);
    if (IsNeverTogether(pair, group))
      remarks.push_back(name +
                        " have no capture in common: nothing comes of this pair; `skip_pairs` in session.yaml "
                        "leaves it out.");
    else if (OpenMotion(pair, looked_at) && !OpenMotion(pair, group))
      remarks.push_back(name +
                        " leaves a direction open; pairs with a lidar, whose clouds were not looked at, may close it.");
  }
  if (auto unchecked = Unchecked(findings)) remarks.push_back(std::move(*unchecked));
  return remarks;
}

}  // namespace rigcal::check

#include "server/formats/yaml/policy_yaml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "server/base/text.h"
#include "server/formats/json/nearest.h"
#include "server/formats/yaml/yaml_field.h"
#include "server/model/graph/pose_results.h"

namespace rigcal::formats {
namespace {

constexpr const char* kPolicyCure = "Mend it; docs/policy.md lists every key with its unit.";
constexpr std::int64_t kCapturesMinMost = 100'000;
constexpr double kNsPerDay = 86'400e9;
constexpr std::string_view kNotNeeded = "not_needed";

// What a limit may be, in the unit in which it is written. The least is told so that what is told is taken.
struct Bounds {
  std::string_view unit;
  double least, most;
  const char* least_told;
};
constexpr std::array<Bounds, 5> kBounds = {{{"mm", 1e-3, 10'000, "0.001"},
                                            {"deg", 1e-4, 180, "0.0001"},
                                            {"px_at_10_m", 1e-3, 10'000, "0.001"},
                                            {"days", 1.0 / 24, 36'500, "0.0416667 (1 h)"},
                                            {"percent", 1e-3, 10, "0.001"}}};

// Of a limit above 0 that is below its least.
enum class TooSmall { kRefused, kRaised };

// What else may be measured in a unit that somebody writes, and how many of the key's unit it is.
struct OtherUnit {
  std::string_view written, wanted;
  double times;
};
constexpr std::array<OtherUnit, 11> kOtherUnits = {{{"m", "mm", 1000},
                                                    {"cm", "mm", 10},
                                                    {"um", "mm", 1e-3},
                                                    {"mm", "mm", 1},
                                                    {"rad", "deg", kDegreesOfRadian},
                                                    {"mrad", "deg", kDegreesOfRadian / 1000},
                                                    {"deg", "deg", 1},
                                                    {"d", "days", 1},
                                                    {"days", "days", 1},
                                                    {"h", "days", 1.0 / 24},
                                                    {"weeks", "days", 7}}};

std::string Short(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
  return {text.data(), end};
}

// A number and what stands behind it; nothing where no number begins the text.
struct Quantity {
  double value = 0.0;
  std::string_view unit;
};
std::optional<Quantity> QuantityOf(std::string_view text) {
  Quantity quantity;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), quantity.value);
  if (error != std::errc()) return std::nullopt;
  quantity.unit = text.substr(static_cast<std::size_t>(stop - text.data()));
  quantity.unit.remove_prefix(std::min(quantity.unit.find_first_not_of(' '), quantity.unit.size()));
  return quantity;
}

// How many of `wanted` one `unit` is; 0: they measure different things, or it is no unit.
double TimesOf(std::string_view unit, std::string_view wanted) {
  for (const OtherUnit& other : kOtherUnits)
    if (other.written == unit && other.wanted == wanted) return other.times;
  return 0.0;
}

const Bounds& BoundsOf(std::string_view unit) {
  return *std::find_if(kBounds.begin(), kBounds.end(), [unit](const Bounds& one) { return one.unit == unit; });
}

// Within the bounds of its unit. "5 cm" is told as what it is in millimetres.
double ReadBounded(const YamlField& field, std::string_view unit, TooSmall small) {
  const std::string text = field.Text();
  if (const auto quantity = QuantityOf(text); quantity && !quantity->unit.empty())
    if (const double times = TimesOf(quantity->unit, unit); times > 0.0)
      field.Refuse("is in " + std::string(unit) + ": write " + Short(quantity->value * times) + ", not " +
                   Quoted(text));
  const double value = field.Number();
  const Bounds& bounds = BoundsOf(unit);
  if (small == TooSmall::kRaised && value > 0.0 && value < bounds.least) return bounds.least;
  if (value >= bounds.least && value <= bounds.most) return value;
  field.Refuse("must be from " + std::string(bounds.least_told) + " to " + Short(bounds.most) + ", not " +
               Quoted(text));
  return bounds.least;
}

std::string KeyOf(const LimitName& name) { return std::string(name.name) + "_" + name.written; }

std::vector<std::string> LimitKeys(bool of_pair) {
  std::vector<std::string> keys;
  for (const LimitName& one : kLimitNames)
    if (one.of_pairs || !of_pair) keys.push_back(KeyOf(one));
  if (!of_pair) keys.emplace_back(kNotNeeded);
  return keys;
}

// "z" of "z of left"; empty: it does not say whose.
std::string_view AxisOf(std::string_view result) {
  constexpr std::string_view kOf = " of ";
  const std::size_t at = result.find(kOf);
  return at == std::string_view::npos || at + kOf.size() == result.size() ? "" : result.substr(0, at);
}

// `not_needed: [height]`, `not_needed: [z of left]`.
void ReadNotNeeded(const YamlField& member, std::set<std::string>& results) {
  constexpr const char* kCure = "Write some of forward, sideways, height, roll, pitch and yaw: not_needed: [height].";
  const std::vector<std::string_view> of_robot(kRobotResults.begin(), kRobotResults.end());
  const auto is_of = [](const auto& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const YamlField& item : member.Items()) {
    const std::string result = item.Text();
    if (is_of(kFrameResults, result))
      item.Refuse(
          Quoted(result) + " is another axis with another reference sensor",
          "Write forward, sideways, height, roll, pitch or yaw of the robot, or whose axis it is: not_needed: [" +
              result + " of SENSOR].");
    if (!is_of(kRobotResults, result) && !is_of(kFrameResults, AxisOf(result)))
      item.Refuse(Quoted(result) + " is no result of a pose; " + DidYouMean(result, of_robot), kCure);
    results.insert(result);
  }
  if (results.size() > kNotNeededMax)
    member.Refuse("has more than " + std::to_string(kNotNeededMax) + " entries", kCure);
}

// False: it is no limit of a sensor, or of a pair.
bool ReadLimit(const YamlField& member, bool of_pair, TooSmall small, LimitWords& words) {
  if (member.Key() == kNotNeeded && !of_pair) return ReadNotNeeded(member, words.not_needed.emplace()), true;
  for (const LimitName& one : kLimitNames) {
    if (member.Key() != KeyOf(one) || (of_pair && !one.of_pairs)) continue;
    words.*one.value = ReadBounded(member, one.written, small) / one.divisor;
    return true;
  }
  return false;
}

// A known key in another unit: "tolerance_m" is told as tolerance_mm, with its value.
bool RefuseUnit(const YamlField& member, const std::string& known) {
  const std::size_t cut = known.rfind('_') + 1;
  const std::string_view key = member.Key(), wanted = std::string_view(known).substr(cut);
  if (key.substr(0, cut) != std::string_view(known).substr(0, cut)) return false;
  const double times = TimesOf(key.substr(cut), wanted);
  if (!(times > 0.0)) return false;
  const auto quantity = QuantityOf(member.Text());
  member.Refuse(
      "unknown key " + Quoted(key) + "; write " + known +
      (quantity && quantity->unit.empty() ? ": " + Short(quantity->value * times) : ", in " + std::string(wanted)));
  return true;
}

void RefuseKey(const YamlField& member, const std::vector<std::string>& known) {
  for (const std::string& one : known)
    if (RefuseUnit(member, one)) return;
  const std::vector<std::string_view> names(known.begin(), known.end());
  member.Refuse("unknown key " + Quoted(member.Key()) + "; " + DidYouMean(member.Key(), names));
}

LimitWords ReadWords(const YamlField& map, const std::string& title, bool of_pair, TooSmall small) {
  LimitWords words;
  for (const YamlField& member : map.Members())
    if (!ReadLimit(member.Called(title + ": " + member.Key()), of_pair, small, words))
      RefuseKey(member.Called(title), LimitKeys(of_pair));
  return words;
}

SensorId ReadSensorName(const YamlField& place, std::string_view text) {
  auto id = SensorId::Parse(text);
  if (!id) place.Refuse(id.error().what, id.error().cure);
  return id.value_or(SensorId());
}

// "left - right", in either order.
SensorPair ReadPairName(const YamlField& place) {
  constexpr std::string_view kBetween = " - ";
  const std::string_view key = place.Key();
  const std::size_t at = key.find(kBetween);
  if (at == std::string_view::npos) {
    place.Refuse("a pair is written as two sensors, `left - right`, not " + Quoted(key));
    return {};
  }
  const SensorId a = ReadSensorName(place, key.substr(0, at)),
                 b = ReadSensorName(place, key.substr(at + kBetween.size()));
  if (a == b) place.Refuse("a pair is of two sensors, not of " + Quoted(key));
  return {std::min(a, b), std::max(a, b)};
}

void ReadSensorLimits(const YamlField& sensors, TooSmall small, Policy& policy) {
  for (const YamlField& sensor : sensors.Members()) {
    const SensorId id = ReadSensorName(sensor, sensor.Key());
    policy.sensors[id] = ReadWords(sensor, "sensor '" + id.str() + "'", false, small);
  }
}

void ReadPairLimits(const YamlField& pairs, TooSmall small, Policy& policy) {
  for (const YamlField& pair : pairs.Members()) {
    const SensorPair names = ReadPairName(pair);
    const std::string title = "pair '" + names.a.str() + " - " + names.b.str() + "'";
    if (policy.pairs.contains(names)) pair.Called(title).Refuse("is there twice");
    policy.pairs[names] = ReadWords(pair, title, true, small);
  }
}

ApprovalBy ReadApproval(const YamlField& member) {
  const std::string text = member.Text();
  if (text != NameOf(ApprovalBy::kAutomatic) && text != NameOf(ApprovalBy::kPerson))
    member.Refuse("must be automatic or person, not " + Quoted(text));
  return ApprovalByOf(text);
}

bool ReadTrueOrFalse(const YamlField& member) {
  const std::string text = member.Text();
  if (text != "true" && text != "false") member.Refuse("must be true or false, not " + Quoted(text));
  return text == "true";
}

// False: it is none of those that are for the whole robot.
bool ReadOther(const YamlField& member, TooSmall small, Policy& policy) {
  const std::string& key = member.Key();
  if (key == "residual_max_mm") return policy.residual_max_m = ReadBounded(member, "mm", small) / 1000, true;
  if (key == "residual_max_deg")
    return policy.residual_max_rad = ReadBounded(member, "deg", small) / kDegreesOfRadian, true;
  if (key == "max_age_days")
    return policy.max_age_ns = std::llround(ReadBounded(member, "days", small) * kNsPerDay), true;
  if (key == "captures_min") return policy.captures_min = member.Integer(1, kCapturesMinMost), true;
  if (key == "approval") return policy.approval = ReadApproval(member), true;
  if (key == "approve_warnings") return policy.approve_warnings = ReadTrueOrFalse(member), true;
  if (key == "approve_drift") return policy.approve_drift = ReadTrueOrFalse(member), true;
  if (key == "drift_false_alarm_percent")
    return policy.drift_false_alarm_ratio = ReadBounded(member, "percent", small) / 100, true;
  if (key == "visits_in_full") return policy.visits_in_full = member.Integer(kVisitsInFullMin, kVisitsInFullMax), true;
  if (key == "sensors") return ReadSensorLimits(member, small, policy), true;
  if (key == "pairs") return ReadPairLimits(member, small, policy), true;
  return false;
}

std::vector<std::string> KeysOfPolicy() {
  std::vector<std::string> keys = LimitKeys(false);
  for (const char* other :
       {"residual_max_mm", "residual_max_deg", "max_age_days", "captures_min", "approval", "approve_warnings",
        "approve_drift", "drift_false_alarm_percent", "visits_in_full", "sensors", "pairs"})
    keys.emplace_back(other);
  return keys;
}

Result<Policy> ReadPolicyText(std::string_view text, const std::string& name, TooSmall small) {
  RIGCAL_ASSIGN(const std::unique_ptr<YamlTree> tree, ParseYaml(text, name, kPolicyCure, kPolicyBytesMax));
  Policy policy;
  if (tree->root.kind == YamlNode::Kind::kNull) return policy;  // comments only
  for (const YamlField& member : YamlField(*tree).Members())
    if (!ReadLimit(member, false, small, policy.all) && !ReadOther(member, small, policy))
      RefuseKey(member, KeysOfPolicy());
  if (tree->error) return Fail(*tree->error);
  return policy;
}

}  // namespace

Result<Policy> ReadPolicy(std::string_view text, const std::string& name) {
  return ReadPolicyText(text, name, TooSmall::kRefused);
}

Result<Policy> ReadStoredPolicy(std::string_view text, const std::string& name) {
  return ReadPolicyText(text, name, TooSmall::kRaised);
}

}  // namespace rigcal::formats

#include "client/import/rig_map.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "client/import/files/yaml_out.h"
#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal::importing {
namespace {

using formats::YamlField;
using formats::YamlNode;

constexpr const char* kCure = "See docs/bags.md; `rigcal import BAG --list --write-rig rig.yaml` writes a first one.";
constexpr double kTolerance_sMax = 1.0, kEvery_sMax = 86'400.0;
const std::set<std::string> kOwnKeys = {"topic", "frame", "child_frame", "stamp", "clock_offset_s"};
constexpr double kClockOffset_sMax = 10.0, kMotion_pxMax = 100.0, kMotion_mMax = 1.0;

std::int64_t Nanoseconds(const YamlField& field, double most_s) {
  const double value_s = field.Number();
  if (value_s >= 0 && value_s <= most_s) return std::llround(value_s * 1e9);
  field.Refuse("must be 0 to " + std::to_string(static_cast<int>(most_s)) + " seconds");
  return 0;
}

MappedSensor ReadSensor(const YamlField& field) {
  MappedSensor sensor;
  sensor.id = SensorId(field.Key());
  const auto kind = SensorKindOf(field.At("type").Text());
  if (!kind) field.Refuse(kind.error().what);
  if (kind) sensor.kind = *kind;
  sensor.topic = field.At("topic").Text();
  if (const auto frame = field.Find("frame")) sensor.frame = frame->Text();
  if (const auto child = field.Find("child_frame")) sensor.child_frame = child->Text();
  if (sensor.frame.empty() != sensor.child_frame.empty()) field.Refuse("`frame` and `child_frame` belong together");
  const auto stamp = field.Find("stamp");
  const std::string source = stamp ? stamp->Text() : "header";
  if (stamp && source != "header" && source != "log") stamp->Refuse("must be header or log");
  sensor.stamp = source == "log" ? StampSource::kLog : StampSource::kHeader;
  if (const auto offset = field.Find("clock_offset_s")) {
    sensor.clock_offset_s = offset->Number();
    if (!(std::abs(*sensor.clock_offset_s) <= kClockOffset_sMax)) offset->Refuse("must be -10 to 10 seconds");
  }
  return sensor;
}

void ReadMoments(const YamlField& options, RigMap& map) {
  const auto positive = [&](std::string_view key, double most, double& value) {
    const auto field = options.Find(key);
    if (!field) return;
    value = field->Number();
    if (!(value > 0 && value <= most)) field->Refuse("is out of range");
  };
  positive("motion_px", kMotion_pxMax, map.motion_px);
  positive("motion_m", kMotion_mMax, map.motion_m);
  const auto moments = options.Find("moments");
  if (!moments) return;
  const std::string word = moments->Text();
  if (word != "auto" && word != "all" && word != "still") moments->Refuse("must be auto, all or still");
  map.moments = word == "all" ? MomentsWanted::kAll : word == "still" ? MomentsWanted::kStill : MomentsWanted::kAuto;
}

void RefuseTwins(const YamlField& sensors, const RigMap& map) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const MappedSensor& sensor : map.sensors)
    if (!seen.emplace(sensor.topic, sensor.child_frame).second)
      sensors.Refuse("two sensors have the topic " + Quoted(sensor.topic) + ", and no frames that tell them apart");
}

// The tree without what is not session.yaml's.
YamlNode SessionTree(const YamlNode& root) {
  YamlNode session = root;
  const auto drop = [](YamlNode& map, const auto& is_own) {
    map.items.erase(
        std::remove_if(map.items.begin(), map.items.end(), [&](const YamlNode& item) { return is_own(item.key); }),
        map.items.end());
  };
  drop(session, [](const std::string& key) { return key == "import"; });
  for (YamlNode& member : session.items)
    for (YamlNode& sensor : member.items)
      if (member.key == "sensors") drop(sensor, [](const std::string& key) { return kOwnKeys.count(key) > 0; });
  return session;
}

}  // namespace

Result<RigMap> ReadRigMap(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const auto tree, formats::ParseYaml(text, name, kCure, limits::kSessionYamlBytesMax));
  const YamlField root(*tree);
  RigMap map;
  if (root.Find("captured_at")) root.Refuse("captured_at is taken from the bag: take it out");
  if (const auto options = root.Find("import")) {
    options->AllowOnly({"tolerance_s", "every_s", "moments", "motion_px", "motion_m"});
    ReadMoments(*options, map);
    if (const auto tolerance = options->Find("tolerance_s"))
      map.tolerance_ns = Nanoseconds(*tolerance, kTolerance_sMax);
    if (const auto every = options->Find("every_s")) map.every_ns = Nanoseconds(*every, kEvery_sMax);
  }
  const YamlField sensors = root.At("sensors");
  for (const YamlField& sensor : sensors.Members())
    map.sensors.push_back(ReadSensor(sensor.Called("sensor '" + sensor.Key() + "'")));
  RefuseTwins(sensors, map);
  if (tree->error) return Fail(*tree->error);
  map.session = SessionTree(tree->root);
  // All else is judged as in a session; the lines of its errors are those of the session.yaml that it would be.
  RIGCAL_ASSIGN(map.header, formats::ReadSessionYaml(SessionYaml(map, Stamp{}), name + " as session.yaml"));
  return map;
}

void AddCondition(const std::string& name, const std::string& text, RigMap& map) {
  std::vector<YamlNode>& members = map.session.items;
  auto conditions =
      std::find_if(members.begin(), members.end(), [](const YamlNode& one) { return one.key == "conditions"; });
  if (conditions == members.end()) {
    members.push_back({YamlNode::Kind::kMap, "conditions", 0, {}, {}});
    conditions = members.end() - 1;
  }
  conditions->kind = YamlNode::Kind::kMap;  // a map without members is read as nothing
  std::erase_if(conditions->items, [&](const YamlNode& one) { return one.key == name; });
  conditions->items.push_back({YamlNode::Kind::kText, name, 0, text, {}});
}

std::string SessionYaml(const RigMap& map, Stamp captured_at) {
  return "captured_at: " + YamlWord(ToIso(captured_at)) + "\n" + YamlLines(map.session, 0);
}

}  // namespace rigcal::importing

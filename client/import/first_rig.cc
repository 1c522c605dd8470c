#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>
#include <set>

#include "client/bags/messages/header.h"
#include "client/import/files/yaml_out.h"
#include "client/import/rig_map.h"
#include "server/base/limits.h"
#include "server/base/text.h"

namespace rigcal::importing {
namespace {

std::string FolderOf(const std::string& topic) {
  return topic.substr(0, topic.rfind('/') == std::string::npos ? 0 : topic.rfind('/'));
}

// "/left/image_raw" is the sensor "left": words that say what is sent say nothing of who sends it.
std::string SensorNameOf(const std::string& topic) {
  static const std::set<std::string> kWhat = {
      "image",      "image_raw", "image_color", "image_mono",  "image_rect", "image_rect_color",
      "compressed", "points",    "points_raw",  "point_cloud", "pointcloud", "velodyne_points",
      "pose",       "raw",       "data"};
  std::vector<std::string> words(1);
  for (const char c : topic) {
    if (c == '/')
      words.emplace_back();
    else
      words.back() += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
  }
  words.erase(std::remove(words.begin(), words.end(), ""), words.end());
  std::string name;
  for (const std::string& word : words)
    if (words.size() == 1 || kWhat.count(word) == 0) name += (name.empty() ? "" : "_") + word;
  if (name.empty()) name = words.empty() ? "sensor" : words[0];
  if (std::isalnum(static_cast<unsigned char>(name[0])) == 0 && name[0] != '_') name = "s" + name;
  return name.substr(0, limits::kNameMax - 4);
}

std::string RateText(const TopicSurvey& topic) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g Hz", topic.rate_hz.value_or(0));
  return topic.rate_hz ? std::string(", ") + text : "";
}

std::string SensorLines(const TopicSurvey& topic, const std::string& name,
                        const std::map<std::string, std::string>& lenses) {
  std::string lines = "  " + name + ":\n    type: " + topic.sensor_kind + "\n    topic: " + YamlWord(topic.name) +
                      "   # " + topic.detail + RateText(topic) + "\n";
  const auto lens = lenses.find(FolderOf(topic.name));
  if (topic.sensor_kind == "camera" && lens != lenses.end() && !lens->second.empty())
    lines += "    model: " + lens->second + "   # as its camera info says\n";
  if (topic.count > 1 && topic.unset_stamps * 2 > topic.count) lines += "    stamp: log   # its header has no time\n";
  return lines;
}

constexpr const char* kHead =
    "# Which topic is which sensor (docs/bags.md). What is left open here has to be filled in; take out what is no\n"
    "# sensor of the rig. The same file serves the next bag:  rigcal import BAG --rig rig.yaml --out SESSION\n"
    "format: 1\n"
    "robot:                # the robot's id\n"
    "import:\n"
    "  tolerance_s: 0.005  # messages whose stamps are at most so far apart were taken together\n"
    "  every_s: 0          # at least so long from one capture to the next\n"
    "  moments: auto       # of cameras that run freely the still moments; all: whatever has a partner\n"
    "  motion_px: 0.5      # what is still: it moves by no more in the picture\n"
    "  motion_m: 0.001     # and on the board\n"
    "targets:              # the boards, measured, as in session.yaml:\n"
    "  # board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}\n"
    "sensors:\n";

}  // namespace

std::string FirstRigYaml(const BagSurvey& survey) {
  std::map<std::string, std::string> lenses;  // by the folder of the topic of the camera's info
  std::set<std::string> raw, taken;
  for (const TopicSurvey& topic : survey.topics) {
    if (!topic.lens_model.empty()) lenses[FolderOf(topic.name)] = topic.lens_model;
    if (topic.sensor_kind == "camera") raw.insert(topic.name);
  }
  std::string text = kHead;
  for (const TopicSurvey& topic : survey.topics) {
    // "/left/image_raw/compressed" is the same picture as "/left/image_raw".
    if (topic.sensor_kind.empty() || topic.count == 0 || !IsPrintableUtf8(topic.name) ||
        raw.count(FolderOf(topic.name)) > 0)
      continue;
    const std::string name = SensorNameOf(topic.name);
    std::string unique = name;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = name + "_" + std::to_string(i);
    text += SensorLines(topic, unique, lenses);
  }
  for (const TopicSurvey& topic : survey.topics)
    if (bags::KindOf(topic.type) == bags::MessageKind::kTransforms && IsPrintableUtf8(topic.name))
      text += "  # flange: {type: tracker, topic: " + YamlWord(topic.name) +
              ", frame: base_link, child_frame: tool0}   # " + topic.detail + "\n";
  return text;
}

}  // namespace rigcal::importing

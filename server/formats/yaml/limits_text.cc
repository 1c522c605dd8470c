#include "server/formats/yaml/limits_text.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "server/base/number_text.h"
#include "server/base/text.h"
#include "server/formats/json/nearest.h"
#include "server/formats/yaml/yaml_field.h"

namespace rigcal::formats {
namespace {

using limits::Limits;
using limits::Setting;

constexpr std::size_t kBytesMax = 64 << 10;
constexpr const char* kLimitsCure = "docs/limits.md lists every limit and its range.";
constexpr std::array<std::pair<std::string_view, int>, 3> kUnits = {{{"KiB", 10}, {"MiB", 20}, {"GiB", 30}}};

bool IsOfBytes(const Setting& setting) { return setting.name.ends_with("_bytes"); }

// Takes the unit off the end of `text` and gives its shift.
int TakeUnit(std::string_view& text) {
  for (const auto& [unit, shift] : kUnits)
    if (text.ends_with(unit)) {
      text.remove_suffix(unit.size());
      if (text.ends_with(' ')) text.remove_suffix(1);
      return shift;
    }
  return 0;
}

std::optional<std::int64_t> ValueOf(const Setting& setting, std::string_view text) {
  const int shift = IsOfBytes(setting) ? TakeUnit(text) : 0;
  const auto value = NumberIn<std::int64_t>(text);
  // Compared before it is shifted: no overflow.
  if (!value || *value < 0 || *value > setting.ceiling >> shift || *value << shift < setting.least) return std::nullopt;
  return *value << shift;
}

Result<const Setting*> Find(std::string_view name) {
  const auto all = limits::Settings();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Setting& one) { return one.name == name; });
  if (found != all.end()) return &*found;
  std::vector<std::string_view> names;
  for (const Setting& one : all) names.push_back(one.name);
  return Fail(ErrorCode::kInvalidInput, "limit " + Quoted(name) + " is not known; " + DidYouMean(name, names),
              kLimitsCure);
}

Status Set(std::string_view name, std::string_view text, Limits& limits) {
  RIGCAL_ASSIGN(const Setting* setting, Find(name));
  const auto value = ValueOf(*setting, text);
  if (!value)
    return Fail(ErrorCode::kInvalidInput,
                "limit " + std::string(name) + " must be a whole number from " + std::to_string(setting->least) +
                    " to " + std::to_string(setting->ceiling) + ", not " + Quoted(text),
                kLimitsCure);
  limits.*setting->value = *value;
  return {};
}

}  // namespace

Result<Limits> ReadLimits(std::string_view yaml, const std::string& name, const Limits& limits) {
  RIGCAL_ASSIGN(const std::unique_ptr<YamlTree> tree, ParseYaml(yaml, name, kLimitsCure, kBytesMax));
  Limits changed = limits;
  if (tree->root.kind == YamlNode::Kind::kNull) return changed;  // comments only
  for (const YamlField& member : YamlField(*tree).Members()) {
    const std::string value = member.Text();
    if (tree->error) break;
    if (const Status set = Set(member.Key(), value, changed); !set) member.Refuse(set.error());
  }
  if (tree->error) return Fail(*tree->error);
  return changed;
}

Result<Limits> WithLimit(const Limits& limits, std::string_view assignment) {
  const std::size_t sign = assignment.find('=');
  if (sign == std::string_view::npos)
    return Fail(ErrorCode::kInvalidInput, "limit " + Quoted(assignment) + " is not NAME=VALUE",
                "Write, for instance, open_sessions=16.");
  Limits changed = limits;
  RIGCAL_TRY(Set(assignment.substr(0, sign), assignment.substr(sign + 1), changed));
  return changed;
}

Status CheckTogether(const Limits& limits) {
  if (limits.window_bytes > limits.intake_bytes)
    return Fail(ErrorCode::kInvalidInput,
                "limit window_bytes (" + std::to_string(limits.window_bytes) + ") is above intake_bytes (" +
                    std::to_string(limits.intake_bytes) + "), which all sessions share",
                "Raise intake_bytes or lower window_bytes.");
  if (limits.payload_bytes > limits.session_bytes)
    return Fail(ErrorCode::kInvalidInput,
                "limit payload_bytes (" + std::to_string(limits.payload_bytes) + ") is above session_bytes (" +
                    std::to_string(limits.session_bytes) + "), which holds many files",
                "Raise session_bytes or lower payload_bytes.");
  return {};
}

std::string ChangedLimits(const Limits& limits) {
  std::string text;
  for (const Setting& one : limits::Settings()) {
    if (limits.*one.value == Limits().*one.value) continue;
    text += (text.empty() ? "" : ", ") + std::string(one.name) + "=" + std::to_string(limits.*one.value);
  }
  return text;
}

}  // namespace rigcal::formats

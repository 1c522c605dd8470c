#include "server/report/cameras/field_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/model/sensors/coverage.h"
#include "server/report/cameras/camera_drawing.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

struct PixelClass {
  double from_px;
  const char* text;
};
constexpr std::array<PixelClass, 5> kPixelClasses = {
    {{0.0, "below 0.1"}, {0.1, "0.1 to 0.3"}, {0.3, "0.3 to 1"}, {1.0, "1 to 3"}, {3.0, "3 and more"}}};

std::size_t ClassOf(double value_px) {
  std::size_t level = 0;
  while (level + 1 < kPixelClasses.size() && value_px >= kPixelClasses[level + 1].from_px) ++level;
  return level;
}

std::string CornerOf(const FieldMap& map, std::size_t field) {
  return std::to_string(static_cast<int>(field) % map.columns) + " " +
         std::to_string(static_cast<int>(field) / map.columns);
}

// Fields of a class as one path, neighbours in a row as one piece.
std::string ClassPath(const FieldMap& map, std::size_t level) {
  const auto is_in = [&](std::size_t field) { return map.value_px[field] && ClassOf(*map.value_px[field]) == level; };
  const auto columns = static_cast<std::size_t>(map.columns);
  std::string path;
  for (std::size_t field = 0; field < map.value_px.size();) {
    std::size_t end = field;
    while (end < map.value_px.size() && is_in(end) && (end == field || end % columns != 0)) ++end;
    if (end > field) {
      const std::string length = std::to_string(end - field);
      path += "M" + CornerOf(map, field) + "h" + length + "v1h-" + length + "z";
    }
    field = std::max(end, field + 1);
  }
  return path;
}

std::string HatchPath(const FieldMap& map) {
  std::string path;
  for (std::size_t field = 0; field < map.seen.size(); ++field)
    if (!map.seen[field]) path += "M" + CornerOf(map, field) + "m0 1l1-1";
  return path;
}

double LongestArrow(const FieldMap& map) {
  double longest_px = 0.0;
  for (const auto& arrow_px : map.arrow_px)
    if (arrow_px) longest_px = std::max(longest_px, arrow_px->norm());
  return longest_px;
}

void FillArrows(Dictionary& drawing, const FieldMap& map) {
  constexpr double kLongest = 24.0, kMagnifiedMax = 100'000.0, kShortest = 0.3;  // drawing units; below: not drawn
  const double longest_px = LongestArrow(map), scale = kMapWidth / std::max(map.width_px, 1);
  if (!(longest_px > 0) || !std::isfinite(longest_px)) return;
  const double magnified = std::min(kMagnifiedMax, NiceBelow(kLongest / (scale * longest_px)));
  std::string path;
  for (std::size_t field = 0; field < map.arrow_px.size(); ++field) {
    if (!map.arrow_px[field] || map.arrow_px[field]->norm() * scale * magnified < kShortest) continue;
    const int column = static_cast<int>(field) % map.columns, row = static_cast<int>(field) / map.columns;
    const Eigen::Vector2d by = *map.arrow_px[field] * scale * magnified;
    path += "M" + Fixed((MiddleOf(column, map.width_px, map.columns) + 0.5) * scale, 1) + " " +
            Fixed((MiddleOf(row, map.height_px, map.rows) + 0.5) * scale, 1) + "l" + Fixed(by.x(), 1) + " " +
            Fixed(by.y(), 1);
  }
  if (path.empty()) return;
  Dictionary* arrows = drawing.AddSectionDictionary("ARROWS");
  arrows->SetValue("D", path);
  arrows->SetValue("MAGNIFIED", Significant(magnified, 1));
}

void FillClasses(Dictionary& drawing, const FieldMap& map) {
  for (std::size_t level = 0; level < kPixelClasses.size(); ++level) {
    const std::string number = std::to_string(level + 1);
    Dictionary* key = drawing.AddSectionDictionary("KEY");
    key->SetValue("LEVEL", number);
    key->SetValue("TEXT", kPixelClasses[level].text);
    const std::string path = ClassPath(map, level);
    if (path.empty()) continue;
    Dictionary* heat = drawing.AddSectionDictionary("HEAT");
    heat->SetValue("LEVEL", number);
    heat->SetValue("D", path);
  }
}

// "upper left", "left", "top", "middle".
std::string PlaceText(const FieldMap& map, std::size_t field) {
  const int column = static_cast<int>(field) % map.columns, row = static_cast<int>(field) / map.columns;
  const bool left = 3 * column < map.columns - 1, right = 3 * (map.columns - 1 - column) < map.columns - 1;
  const bool upper = 3 * row < map.rows - 1, lower = 3 * (map.rows - 1 - row) < map.rows - 1;
  const std::string side = left ? "left" : right ? "right" : "";
  if (side.empty()) return upper ? "at the top" : lower ? "at the bottom" : "in the middle";
  return "at the " + std::string(upper ? "upper " : lower ? "lower " : "") + side;
}

}  // namespace

std::string MapHeightText(int width_px, int height_px) {
  if (width_px <= 0 || height_px <= 0) return "240";
  return Fixed(std::clamp(kMapWidth / width_px * height_px, 40.0, 720.0), 0);
}

std::optional<WorstField> WorstOf(const FieldMap& map, const std::vector<bool>& among) {
  std::optional<std::size_t> worst;
  for (std::size_t field = 0; field < map.value_px.size(); ++field) {
    if (!map.value_px[field] || (field < among.size() && !among[field])) continue;
    if (!worst || *map.value_px[field] > *map.value_px[*worst]) worst = field;
  }
  if (!worst) return std::nullopt;
  return WorstField{*map.value_px[*worst], PlaceText(map, *worst)};
}

std::optional<double> MiddleValue(const FieldMap& map) {
  const auto field = static_cast<std::size_t>(map.rows / 2 * map.columns + map.columns / 2);
  return field < map.value_px.size() ? map.value_px[field] : std::nullopt;
}

std::string PixelsText(double value_px) {
  constexpr double kLeast_px = 0.001;
  return value_px < kLeast_px ? "below " + Significant(kLeast_px, 1) + " px" : Significant(value_px, 2) + " px";
}

void FillFieldMap(Dictionary& parent, const FieldMap& map, const std::string& label) {
  Dictionary* drawing = parent.AddIncludeDictionary("FIELD_MAP");
  drawing->SetFilename("field_map.tpl");
  drawing->SetValue("LABEL", label);
  drawing->SetValue("MAP_HEIGHT", MapHeightText(map.width_px, map.height_px));
  drawing->SetValue("COLUMNS", std::to_string(map.columns));
  drawing->SetValue("ROWS", std::to_string(map.rows));
  FillClasses(*drawing, map);
  if (const std::string hatch = HatchPath(map); !hatch.empty()) ShowValue(*drawing, "UNSEEN", "D", hatch);
  if (std::any_of(map.value_px.begin(), map.value_px.end(), [](const auto& value) { return !value; }))
    drawing->ShowSection("BLANK");
  FillArrows(*drawing, map);
}

}  // namespace rigcal::report

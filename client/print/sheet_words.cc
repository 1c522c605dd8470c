#include "client/print/sheet_words.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "server/model/boards/measure.h"

namespace rigcal::print {
namespace {

// The shortest digits that read back as the same number, not those of 1e-7 of a millimetre.
std::string Metres(double length_m) {
  const double rounded = std::round(length_m * 1e9) / 1e9;
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), rounded, std::chars_format::fixed).ptr;
  return {text.data(), end};
}

std::string PairText(int a, int b) { return "[" + std::to_string(a) + ", " + std::to_string(b) + "]"; }

// In double quotes where YAML would read something else.
std::string YamlText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += (c == '"' || c == '\\') ? std::string("\\") + c : std::string(1, c);
  return quoted + "\"";
}

// What is printed beside counts and size.
std::string MarkerText(const Target& target) {
  if (target.kind == TargetKind::kCheckerboard) return "";
  if (IsCircleGrid(target.kind)) return ", circles of " + BoardMm(target.diameter_m);
  std::string text = ", " + target.dictionary;
  if (target.kind == TargetKind::kCharuco) text += ", markers " + BoardMm(target.marker_m);
  if (IsTagGrid(target.kind)) text += ", gaps " + BoardMm(target.square_m * target.spacing_ratio);
  if (!target.marker_ids.empty()) text += ", ids from " + std::to_string(target.marker_ids.front());
  return text;
}

// As large as the strip allows, up to `height_m`. An em of these fonts is at most `ems` high per character.
double FittingHeight_m(const std::string& text, double ems, double height_m, double width_m) {
  return std::min(height_m, width_m / (ems * static_cast<double>(std::max<std::size_t>(text.size(), 1))));
}

}  // namespace

std::string YamlOf(const Target& target) {
  const TypedCounts counts = TypedCountsOf(PatternOf(target));
  const bool grid = IsTagGrid(target.kind), charuco = target.kind == TargetKind::kCharuco;
  const bool circles = IsCircleGrid(target.kind);
  std::string text = "{type: " + NameOf(target.kind) +
                     (grid      ? ", tags: "
                      : charuco ? ", squares: "
                      : circles ? ", circles: "
                                : ", inner_corners: ") +
                     PairText(counts.cols, counts.rows) + ", " + SizeFieldOf(target.kind) + ": " +
                     Metres(target.square_m);
  if (circles) text += ", diameter_m: " + Metres(target.diameter_m);
  if (charuco) text += ", marker_size_m: " + Metres(target.marker_m);
  if (grid) text += ", spacing_ratio: " + Metres(target.spacing_ratio);
  if (charuco || grid) text += ", dictionary: " + target.dictionary;
  if (!target.marker_ids.empty()) text += ", first_id: " + std::to_string(target.marker_ids.front());
  return text + ", serial: " + YamlText(target.serial) + "}";
}

std::vector<Label> WordsOf(const Target& target, double x_m, double y_m, double width_m) {
  constexpr double kMono = 0.61, kSans = 0.6;
  const BoardPattern pattern = PatternOf(target);
  const std::string what = target.serial + "   " + TextOf(pattern) + MarkerText(target);
  const std::string how =
      "Print at 100 %, without scaling. Glue it flat. Measure both rulers from the first line to the last, in mm, and "
      "enter them:";
  const std::string command = MeasureCommand(target.serial, &pattern);
  const std::string yaml = "session.yaml: " + YamlOf(target);
  return {{x_m, y_m + 0.007, FittingHeight_m(what, kSans, 0.006, width_m), what, false},
          {x_m, y_m + 0.014, FittingHeight_m(how, kSans, 0.003, width_m), how, false},
          {x_m, y_m + 0.019, FittingHeight_m(command, kMono, 0.003, width_m), command, true},
          {x_m, y_m + 0.025, FittingHeight_m(yaml, kMono, 0.003, width_m), yaml, true}};
}

}  // namespace rigcal::print

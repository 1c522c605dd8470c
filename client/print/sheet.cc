#include "client/print/sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "client/print/sheet_words.h"
#include "server/model/boards/measure.h"

namespace rigcal::print {
namespace {

struct Paper {
  const char* name;
  double short_m, long_m;
};
// `auto` tries them in this order, letter aside.
constexpr std::array<Paper, 6> kPapers = {{{"A4", 0.210, 0.297},
                                           {"A3", 0.297, 0.420},
                                           {"A2", 0.420, 0.594},
                                           {"A1", 0.594, 0.841},
                                           {"A0", 0.841, 1.189},
                                           {"letter", 0.2159, 0.2794}}};
constexpr const char* kAutoPaper = "auto";

constexpr double kMargin_m = 0.010;      // that printers leave white
constexpr double kRulerStrip_m = 0.014;  // ticks and their numbers
constexpr double kRulerTick_m = 0.1, kTenth_m = 0.01;
constexpr double kLine_m = 0.0002;

// White around the pattern, for the detector.
double QuietZone_m(const Target& target) {
  return std::max(0.006, target.square_m / (IsTagGrid(target.kind) ? 10 : 2));
}

struct Room {
  double width_m = 0, height_m = 0;
};
Room Needed(const Target& target, const Pattern& pattern) {
  const double quiet_m = QuietZone_m(target);
  const double least_m = kRulerTick_m + kTenth_m;  // a ruler of 100 mm
  return {2 * kMargin_m + kRulerStrip_m + std::max(least_m, quiet_m + pattern.width_m),
          2 * kMargin_m + kRulerStrip_m + kWordsHeight_m + std::max(least_m, quiet_m + pattern.height_m)};
}

// As it lies; upright where it fits both ways.
std::optional<Room> Fitting(const Paper& paper, const Room& needed) {
  constexpr double kRounding_m = 1e-9;
  for (const Room& room : {Room{paper.short_m, paper.long_m}, Room{paper.long_m, paper.short_m}})
    if (needed.width_m <= room.width_m + kRounding_m && needed.height_m <= room.height_m + kRounding_m) return room;
  return std::nullopt;
}

Room CustomPaper(const Room& needed) {
  return {std::ceil(needed.width_m * 100 - 1e-6) / 100, std::ceil(needed.height_m * 100 - 1e-6) / 100};
}

tl::unexpected<Error> TooLarge(const std::string& paper, const Room& needed, TargetKind kind) {
  std::string larger = "--paper auto, for a sheet of its own size";
  for (std::size_t i = kPapers.size(); i-- > 0;)
    if (std::string(kPapers[i].name) != "letter" && Fitting(kPapers[i], needed))
      larger = "--paper " + std::string(kPapers[i].name);
  const auto mm = [](double length_m) { return std::to_string(static_cast<int>(std::ceil(length_m * 1000 - 1e-6))); };
  return Fail(ErrorCode::kInvalidInput,
              "the board does not fit on " + paper + ": with rulers and margins it needs " + mm(needed.width_m) +
                  " x " + mm(needed.height_m) + " mm",
              "Use " + larger + ", or a board of fewer " +
                  (IsCircleGrid(kind) ? "circles, or of circles that are nearer to each other."
                                      : "or smaller " + std::string(IsTagGrid(kind) ? "tags." : "squares.")));
}

Result<Room> ChoosePaper(const std::string& paper, const Room& needed, TargetKind kind, std::string& name) {
  const bool is_auto = paper == kAutoPaper;
  for (const Paper& one : kPapers) {
    name = one.name;
    if (is_auto ? name == "letter" : name != paper) continue;
    if (const auto room = Fitting(one, needed)) return *room;
    if (!is_auto) return TooLarge(paper, needed, kind);
  }
  name = "custom";
  if (is_auto) return CustomPaper(needed);
  return Fail(ErrorCode::kInvalidInput, "paper '" + paper + "' is not known",
              "Use A4, A3, A2, A1, A0, letter or auto.");
}

// Centred on the places that the numbers name; lines of 10, 50 and 100 mm differ in length.
void AddRuler(double x_m, double y_m, double length_m, bool is_across, Sheet& sheet) {
  const auto add = [&](double along_m, double from_m, double width_m, double depth_m) {
    sheet.black.push_back(is_across ? Rectangle{x_m + along_m, y_m + from_m, width_m, depth_m}
                                    : Rectangle{x_m - from_m - depth_m, y_m + along_m, depth_m, width_m});
  };
  add(-kLine_m / 2, 0, length_m + kLine_m, kLine_m);
  const int tenths = static_cast<int>(std::lround(length_m / kTenth_m));
  for (int i = 0; i <= tenths; ++i) {
    const double depth_m = i % 10 == 0 ? 0.006 : i % 5 == 0 ? 0.0045 : 0.003;
    add(i * kTenth_m - kLine_m / 2, kLine_m, kLine_m, depth_m);
    if (i % 10 != 0) continue;
    const std::string number = std::to_string(i * 10) + (i == tenths ? " mm" : "");
    if (is_across)
      sheet.labels.push_back({x_m + i * kTenth_m + 0.0008, y_m + 0.0068, 0.0032, number, false});
    else
      sheet.labels.push_back({x_m - 0.0135, y_m + i * kTenth_m + 0.0045, 0.0028, number, false});
  }
}

double WholeRuler_m(double room_m) { return std::floor(room_m / kRulerTick_m + 1e-9) * kRulerTick_m; }

// The y ruler stands at the left, the x ruler lies below the pattern, the words below that.
Sheet PutTogether(const Target& target, const Pattern& pattern, const Room& room, std::string name) {
  const double quiet_m = QuietZone_m(target), left_m = kMargin_m + kRulerStrip_m;
  const double bottom_m = room.height_m - kMargin_m - kWordsHeight_m - kRulerStrip_m;
  Sheet sheet{std::move(name), room.width_m, room.height_m, 0, 0, 0, 0, {}, {}, {}};
  sheet.pattern_x_m = left_m + quiet_m + (room.width_m - kMargin_m - left_m - quiet_m - pattern.width_m) / 2;
  sheet.pattern_y_m = kMargin_m + (bottom_m - quiet_m - kMargin_m - pattern.height_m) / 2;
  for (Rectangle one : pattern.black) {
    one.x_m += sheet.pattern_x_m, one.y_m += sheet.pattern_y_m;
    sheet.black.push_back(one);
  }
  for (Disc one : pattern.discs) {
    one.x_m += sheet.pattern_x_m, one.y_m += sheet.pattern_y_m;
    sheet.discs.push_back(one);
  }
  constexpr double kNumber_m = kTenth_m;  // of the last tick, beyond the ruler
  sheet.ruler_x_m = WholeRuler_m(room.width_m - kMargin_m - left_m - kNumber_m);
  sheet.ruler_y_m = WholeRuler_m(bottom_m - kMargin_m - kNumber_m);
  AddRuler(left_m, bottom_m, sheet.ruler_x_m, true, sheet);
  AddRuler(left_m, kMargin_m, sheet.ruler_y_m, false, sheet);
  for (Label& label : WordsOf(target, kMargin_m, bottom_m + kRulerStrip_m, room.width_m - 2 * kMargin_m))
    sheet.labels.push_back(std::move(label));
  return sheet;
}

}  // namespace

std::vector<std::string> PaperNames() {
  std::vector<std::string> names;
  for (const Paper& paper : kPapers) names.emplace_back(paper.name);
  names.emplace_back(kAutoPaper);
  return names;
}

Result<Sheet> LayOut(const Target& target, const std::string& paper) {
  RIGCAL_ASSIGN(const Pattern pattern, DrawPattern(target));
  std::string name;
  RIGCAL_ASSIGN(const Room room, ChoosePaper(paper, Needed(target, pattern), target.kind, name));
  return PutTogether(target, pattern, room, std::move(name));
}

}  // namespace rigcal::print

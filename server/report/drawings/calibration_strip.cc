#include "server/report/drawings/calibration_strip.h"

#include <algorithm>
#include <map>

#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr double kStripWidth_px = 132, kStripHeight_px = 36, kStripSide_px = 3, kWorstTop_px = 3, kWorstBottom_px = 20,
                 kAgeTop_px = 23, kAgeBottom_px = 35;
constexpr double kSigmasShown = 2 * kOff_sigmas;  // at the top; what is beyond stands there, too

// Between the first calibration and now.
struct TimeAxis {
  Stamp first;
  double span_ns = 1.0;
  [[nodiscard]] std::string X(Stamp at) const {
    const double part = std::clamp(static_cast<double>(at.ns - first.ns) / span_ns, 0.0, 1.0);
    return Fixed(kStripSide_px + part * (kStripWidth_px - 2 * kStripSide_px), 1);
  }
};

std::string WorstY(double sigmas) {
  const double part = std::clamp(sigmas / kSigmasShown, 0.0, 1.0);
  return Fixed(kWorstBottom_px - part * (kWorstBottom_px - kWorstTop_px), 1);
}

// How long each calibration held: until the next one, the last until now.
std::vector<std::int64_t> AgesOf(const std::vector<CalibrationPoint>& points, Stamp now) {
  std::vector<std::int64_t> ages_ns;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int64_t until_ns = i + 1 < points.size() ? points[i + 1].calibrated_at.ns : now.ns;
    ages_ns.push_back(std::max<std::int64_t>(until_ns - points[i].calibrated_at.ns, 0));
  }
  return ages_ns;
}

std::string AgeY(std::int64_t age_ns, double most_ns) {
  const double part = static_cast<double>(age_ns) / most_ns;
  return Fixed(kAgeBottom_px - part * (kAgeBottom_px - kAgeTop_px), 1);
}

// One path for each colour.
void FillDots(Dictionary& svg, const std::vector<CalibrationPoint>& points, const TimeAxis& axis) {
  std::map<std::string, std::string> paths;
  for (const CalibrationPoint& point : points)
    if (point.worst_sigmas)
      paths[SigmasClass(*point.worst_sigmas)] +=
          "M" + axis.X(point.calibrated_at) + " " + WorstY(*point.worst_sigmas) + "h0";
  for (const auto& [level, path] : paths) {
    Dictionary* dots = svg.AddSectionDictionary("DOTS");
    dots->SetValue("LEVEL", level);
    dots->SetValue("D", path);
  }
}

// Teeth: each rises from nothing to the age at which the next calibration came.
void FillAges(Dictionary& svg, const RobotSummary& robot, const TimeAxis& axis, Stamp now) {
  const std::vector<CalibrationPoint>& points = robot.calibrations;
  const std::vector<std::int64_t> ages_ns = AgesOf(points, now);
  const std::int64_t limit_ns = robot.validity.max_age_ns;
  const double most_ns =
      std::max(1.0, static_cast<double>(std::max(limit_ns, *std::max_element(ages_ns.begin(), ages_ns.end()))));
  const std::string bottom = Fixed(kAgeBottom_px, 1);
  std::string path = "M" + axis.X(points.front().calibrated_at) + " " + bottom;
  for (std::size_t i = 0; i < points.size(); ++i)
    path += "L" + axis.X({points[i].calibrated_at.ns + ages_ns[i]}) + " " + AgeY(ages_ns[i], most_ns) + "V" + bottom;
  svg.SetValue("AGES", path + "Z");
  svg.SetValue("AGE_LIMIT", AgeY(limit_ns, most_ns));
}

}  // namespace

std::string CalibrationStripText(const std::vector<CalibrationPoint>& calibrations) {
  std::int64_t apart_ns = 0;
  for (std::size_t i = 1; i < calibrations.size(); ++i)
    apart_ns = std::max(apart_ns, calibrations[i].calibrated_at.ns - calibrations[i - 1].calibrated_at.ns);
  std::string text = Count(calibrations.size(), "calibration", "calibrations") + " since " +
                     DayText(calibrations.front().calibrated_at) + ", at most " + AgeText(apart_ns) + " apart";
  std::vector<double> sigmas;
  for (const CalibrationPoint& point : calibrations)
    if (point.worst_sigmas) sigmas.push_back(*point.worst_sigmas);
  if (sigmas.empty()) return text;
  const auto [least, most] = std::minmax_element(sigmas.begin(), sigmas.end());
  return text + "; worst edge " + SigmasText(*least) + " to " + SigmasText(*most) + " sigma";
}

void FillCalibrationStrip(Dictionary& cell, const RobotSummary& robot, Stamp now) {
  const std::vector<CalibrationPoint>& points = robot.calibrations;
  if (points.size() < 2) return;
  now.ns = std::max(now.ns, points.back().calibrated_at.ns);
  const TimeAxis axis{points.front().calibrated_at,
                      std::max(1.0, static_cast<double>(now.ns - points.front().calibrated_at.ns))};
  Dictionary* svg = cell.AddSectionDictionary("STRIP")->AddIncludeDictionary("DRAWING");
  svg->SetFilename("strip.tpl");
  svg->SetValue("WIDTH", Fixed(kStripWidth_px, 0));
  svg->SetValue("HEIGHT", Fixed(kStripHeight_px, 0));
  svg->SetValue("LABEL", CalibrationStripText(points));
  svg->SetValue("LEFT", Fixed(kStripSide_px, 0));
  svg->SetValue("RIGHT", Fixed(kStripWidth_px - kStripSide_px, 0));
  svg->SetValue("OFF", WorstY(kOff_sigmas));
  FillAges(*svg, robot, axis, now);
  FillDots(*svg, points, axis);
}

}  // namespace rigcal::report

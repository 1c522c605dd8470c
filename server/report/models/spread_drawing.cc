#include "server/report/models/spread_drawing.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr double kLineLeft_px = 26, kPlot_px = 300, kLineHeight_px = 22, kLineTop_px = 8, kRight_px = 96, kBox_px = 12;
constexpr std::array<const char*, 6> kLineNames = {"x", "y", "z", "rx", "ry", "rz"};

// What is at the ends of a line, m or rad.
double ScaleEnd(const SensorPopulation& sensor, bool turns) {
  double reach = turns ? sensor.tolerance.rad : sensor.tolerance.m;
  for (std::size_t axis = turns ? 3 : 0; axis < (turns ? 6U : 3U); ++axis)
    reach = std::max({reach, std::abs(sensor.axes[axis].min), std::abs(sensor.axes[axis].max)});
  return reach > 0.0 && std::isfinite(reach) ? reach : 1.0;
}

struct AxisLine {
  double y_px = 0.0, reach = 1.0;
  [[nodiscard]] std::string X(double value) const {
    return Fixed(kLineLeft_px + kPlot_px / 2 * (1.0 + std::clamp(value / reach, -1.0, 1.0)), 1);
  }
};

// A path of points: a fleet has thousands of them.
std::string DotsOf(const SensorPopulation& sensor, std::size_t axis, const AxisLine& line,
                   const std::set<RobotId>& robots, bool of_these) {
  std::string path;
  for (std::size_t i = 0; i < sensor.robots.size(); ++i)
    if (robots.contains(sensor.robots[i]) == of_these)
      path += "M" + line.X(sensor.offsets[i][static_cast<Eigen::Index>(axis)]) + " " + Fixed(line.y_px, 1) + "h0";
  return path;
}

void FillLine(Dictionary& svg, const SensorPopulation& sensor, std::size_t axis, const std::set<RobotId>& outlying) {
  const bool turns = axis >= 3;
  const AxisLine line{kLineTop_px + kLineHeight_px * (static_cast<double>(axis) + 0.5), ScaleEnd(sensor, turns)};
  const AxisSpread& spread = sensor.axes[axis];
  Dictionary* row = svg.AddSectionDictionary("LINE");
  row->SetValue("NAME", kLineNames[axis]);
  row->SetValue("Y", Fixed(line.y_px, 1));
  row->SetValue("X0", line.X(-line.reach));
  row->SetValue("X1", line.X(line.reach));
  row->SetValue("ZERO", line.X(0.0));
  row->SetValue("TOP", Fixed(line.y_px - kBox_px / 2, 1));
  row->SetValue("BOTTOM", Fixed(line.y_px + kBox_px / 2, 1));
  row->SetValue("BOX_X", line.X(spread.lower));
  row->SetValue("BOX_W", Fixed(std::max(0.0, (spread.upper - spread.lower) / line.reach * kPlot_px / 2), 1));
  row->SetValue("BOX_H", Fixed(kBox_px, 0));
  row->SetValue("MEDIAN", line.X(spread.median));
  row->SetValue("DOTS", DotsOf(sensor, axis, line, outlying, false));
  row->SetValue("TEXT_X", Fixed(kLineLeft_px + kPlot_px + 8, 0));
  row->SetValue("TEXT", ShownNumber(spread.median, turns) + (turns ? " deg" : " mm"));
  if (!outlying.empty()) ShowValue(*row, "OUT", "D", DotsOf(sensor, axis, line, outlying, true));
  const double limit = turns ? sensor.tolerance.rad : sensor.tolerance.m;
  if (!sensor.T_ref_nominal) return;
  for (const double side : {-limit, limit}) {
    Dictionary* mark = row->AddSectionDictionary("LIMIT");
    mark->SetValue("X", line.X(side));
    mark->SetValue("TOP", Fixed(line.y_px - kBox_px / 2, 1));
    mark->SetValue("BOTTOM", Fixed(line.y_px + kBox_px / 2, 1));
  }
}

}  // namespace

std::string ShownNumber(double value, bool turns) {
  constexpr double kLeftOver = 1e-12;
  if (std::abs(value) < kLeftOver) value = 0.0;
  return Significant(value * (turns ? kDegPerRad : kMmPerMetre), 3);
}

void FillSpread(Dictionary& parent, const SensorPopulation& sensor) {
  std::set<RobotId> outlying;
  for (const PopulationOutlier& outlier : sensor.outliers) outlying.insert(outlier.robot);
  Dictionary* svg = parent.AddIncludeDictionary("SPREAD");
  svg->SetFilename("spread.tpl");
  svg->SetValue("WIDTH", Fixed(kLineLeft_px + kPlot_px + kRight_px, 0));
  svg->SetValue("HEIGHT", Fixed(2 * kLineTop_px + 6 * kLineHeight_px, 0));
  svg->SetValue("LABEL", sensor.sensor.str() + " on " + Count(sensor.robots.size(), "robot", "robots") +
                             ": places along x y z and turns about them");
  for (std::size_t axis = 0; axis < sensor.axes.size(); ++axis) FillLine(*svg, sensor, axis, outlying);
}

}  // namespace rigcal::report

#include "server/report/pages/robot_figures.h"

#include <algorithm>

#include "server/report/frame/figure.h"
#include "server/report/text/age.h"
#include "server/report/text/relied.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

Figure AgeFigure(const RobotSummary& robot, Stamp now) {
  const Validity& validity = robot.validity;
  if (IsNever(robot)) return {"Measured", "never", "warn", {"no pair of sensors is calibrated"}};
  return {"Measured",
          AgeOf(*validity.calibrated_at, now),
          validity.overdue ? "warn" : "",
          {DayText(*validity.calibrated_at) + "; " + AgeLimitText(validity)}};
}

// A sensor that was found moved is known again.
bool IsWithinLimits(const SensorStatus& sensor) {
  return sensor.status.word == StatusWord::kOk || sensor.status.word == StatusWord::kDrifted;
}

// What is counted is what the drive rule says.
Figure SensorsFigure(const RobotSummary& robot) {
  const std::vector<SensorStatus>& sensors = robot.sensors;
  const char* name = "Sensors known within limits";
  if (sensors.empty()) return {name, "not judged", "", {}};
  const auto is_counted = [&](const SensorStatus& one) {
    return IsWithinLimits(one) && IsReliedOn(one.sensor, robot.verdict, robot.basis);
  };
  const auto within = std::count_if(sensors.begin(), sensors.end(), is_counted);
  Figure figure{name, std::to_string(within) + " of " + std::to_string(sensors.size()), "", {}};
  const auto first = std::find_if_not(sensors.begin(), sensors.end(), is_counted);
  if (first == sensors.end()) return figure;
  figure.tone = "warn";
  if (within == 0 && IsWithinLimits(*first)) {
    figure.details = {"the verdict vouches for none"};
    return figure;
  }
  const auto others = static_cast<std::ptrdiff_t>(sensors.size()) - within - 1;
  figure.details = {first->sensor.str() + ": " +
                    (IsWithinLimits(*first) ? "not verified" : NameOf(first->status.word)) +
                    (others > 0 ? ", and " + std::to_string(others) + " more" : "")};
  return figure;
}

Figure WorstFigure(const std::optional<WorstEdge>& worst) {
  if (!worst) return {"Worst edge", "none is checked", "warn", {"without a loop every edge fits"}};
  return {"Worst edge",
          SigmasText(worst->in_sigmas) + " \xCF\x83",
          SigmasClass(worst->in_sigmas),
          {worst->frame_a.str() + " \xE2\x86\x92 " + worst->frame_b.str() +
           "; red from 3 \xCF\x83 on, no limit of the policy"}};
}

}  // namespace

void FillRobotFigures(Dictionary& page, const RobotSummary& robot, Stamp now) {
  if (robot.revision == 0) return;
  Dictionary& figures = AddFigures(page);
  const std::optional<Figure> decided = DecidingFigureOf(robot.verdict, robot.basis);
  if (decided) AddFigure(figures, *decided);
  AddFigure(figures, AgeFigure(robot, now));
  AddFigure(figures, SensorsFigure(robot));
  if (!decided) AddFigure(figures, WorstFigure(robot.worst));
}

}  // namespace rigcal::report

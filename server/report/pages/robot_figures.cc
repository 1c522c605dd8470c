#include "server/report/pages/robot_figures.h"

#include <algorithm>

#include "server/report/frame/figure.h"
#include "server/report/text/age.h"
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

Figure SensorsFigure(const std::vector<SensorStatus>& sensors) {
  const char* name = "Sensors known within limits";
  if (sensors.empty()) return {name, "not judged", "", {}};
  const auto within = std::count_if(sensors.begin(), sensors.end(), IsWithinLimits);
  Figure figure{name, std::to_string(within) + " of " + std::to_string(sensors.size()), "", {}};
  const auto first = std::find_if_not(sensors.begin(), sensors.end(), IsWithinLimits);
  if (first == sensors.end()) return figure;
  figure.tone = "warn";
  const auto others = static_cast<std::ptrdiff_t>(sensors.size()) - within - 1;
  figure.details = {first->sensor.str() + ": " + NameOf(first->status.word) +
                    (others > 0 ? ", and " + std::to_string(others) + " more" : "")};
  return figure;
}

Figure WorstFigure(const std::optional<WorstEdge>& worst) {
  if (!worst) return {"Worst edge", "none is checked", "warn", {"without a loop every edge fits"}};
  return {"Worst edge",
          SigmasText(worst->in_sigmas) + " \xCF\x83",
          SigmasClass(worst->in_sigmas),
          {worst->frame_a.str() + " \xE2\x86\x92 " + worst->frame_b.str() + "; 3 \xCF\x83 is hardly chance"}};
}

}  // namespace

void FillRobotFigures(Dictionary& page, const RobotSummary& robot, Stamp now) {
  if (robot.revision == 0) return;
  Dictionary& figures = AddFigures(page);
  AddFigure(figures, AgeFigure(robot, now));
  AddFigure(figures, SensorsFigure(robot.sensors));
  AddFigure(figures, WorstFigure(robot.worst));
}

}  // namespace rigcal::report

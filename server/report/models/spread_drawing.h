// A small drawing of one sensor on all robots: six lines, one per axis, a dot per robot.
#pragma once

#include "server/model/robots/population.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// Metres in mm or radians in degrees, with three digits. What arithmetic leaves over, where zero is the median itself,
// is zero.
[[nodiscard]] std::string ShownNumber(double value, bool turns);

// {{>SPREAD}}: zero is where the drawing has it, or the median of all robots. Axes of one unit share a scale, which
// holds every robot and the tolerance. Box: quartiles; stroke: median; dots that stand out are another colour.
void FillSpread(Dictionary& parent, const SensorPopulation& sensor);

}  // namespace rigcal::report

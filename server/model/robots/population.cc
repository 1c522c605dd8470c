#include "server/model/robots/population.h"

#include <cstdio>

namespace rigcal {
namespace {

std::string ThreeDigits(double value, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.3g %s", value, unit);
  return text.data();
}

std::string LengthsText(const Vector6d& offset) {
  return ThreeDigits(offset.head<3>().norm() * 1000, "mm") + " and " +
         ThreeDigits(offset.tail<3>().norm() * kDegreesOfRadian, "deg");
}

}  // namespace

Vector6d MedianOf(const SensorPopulation& sensor) {
  Vector6d median;
  for (Eigen::Index axis = 0; axis < 6; ++axis) median[axis] = sensor.axes[static_cast<std::size_t>(axis)].median;
  return median;
}

std::vector<std::string> OffTheDrawing(const Population& population) {
  std::vector<std::string> texts;
  for (const SensorPopulation& sensor : population.sensors)
    if (const Vector6d median = MedianOf(sensor); sensor.T_ref_nominal && IsBeyond(median, sensor.tolerance))
      texts.push_back(sensor.sensor.str() + " sits " + LengthsText(median) +
                      " from its nominal (CAD) pose on most robots (" + ThreeDigits(sensor.tolerance.m * 1000, "mm") +
                      " and " + ThreeDigits(sensor.tolerance.rad * kDegreesOfRadian, "deg") + " allowed).");
  return texts;
}

std::vector<std::string> OutlierTexts(const Population& population) {
  std::vector<std::string> texts;
  for (const SensorPopulation& sensor : population.sensors)
    for (const PopulationOutlier& outlier : sensor.outliers)
      texts.push_back(outlier.robot.str() + ": " + sensor.sensor.str() + " sits " +
                      LengthsText(outlier.offset - MedianOf(sensor)) + " from where the others have it.");
  return texts;
}

}  // namespace rigcal

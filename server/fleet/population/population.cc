#include "server/fleet/population/population.h"

#include <algorithm>
#include <set>

#include "server/fleet/population/outliers.h"
#include "server/fleet/population/spread.h"

namespace rigcal::fleet {
namespace {

// A sensor on all robots that have it.
struct Sample {
  std::vector<RobotId> robots;
  std::vector<Se3> poses;
  std::vector<Matrix6d> covariances;
};

std::map<SensorId, Sample> SamplesOf(const std::vector<RobotPlaces>& robots) {
  std::map<SensorId, Sample> samples;
  for (const RobotPlaces& robot : robots)
    for (const auto& [sensor, place] : robot.places) {
      Sample& sample = samples[sensor];
      sample.robots.push_back(robot.robot);
      sample.poses.push_back(place.T_ref_sensor);
      sample.covariances.push_back(place.covariance);
    }
  return samples;
}

void FillSpreads(SensorPopulation& sensor) {
  for (std::size_t axis = 0; axis < sensor.axes.size(); ++axis) {
    std::vector<double> values;
    for (const Vector6d& offset : sensor.offsets) values.push_back(offset[static_cast<Eigen::Index>(axis)]);
    sensor.axes[axis] = SpreadOf(values);
  }
}

std::vector<Vector6d> OffsetsFrom(const Se3& center, const std::vector<Se3>& poses) {
  std::vector<Vector6d> offsets;
  for (const Se3& pose : poses) offsets.push_back((center.Inverse() * pose).Log());
  return offsets;
}

// `limit`: of the odds of one robot and one sensor. Held against each other about their own median: from a drawing that
// has the sensor upside down all offsets are half turns, of either sign.
void FillOutliers(const Sample& sample, double limit, SensorPopulation& sensor) {
  const std::vector<Distance> distances =
      DistancesFromOthers(OffsetsFrom(MedianPose(sample.poses), sample.poses), sample.covariances);
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i].odds < limit)
      sensor.outliers.push_back({sensor.robots[i], sensor.offsets[i], distances[i].worst_axis, distances[i].odds});
  std::stable_sort(sensor.outliers.begin(), sensor.outliers.end(),
                   [](const PopulationOutlier& x, const PopulationOutlier& y) { return x.odds < y.odds; });
  sensor.by_distance = IsByDistance(sensor.robots.size());
}

SensorPopulation Describe(const SensorId& name, const Sample& sample, const RigModel& model,
                          const SensorId& reference) {
  SensorPopulation sensor;
  sensor.sensor = name;
  sensor.robots = sample.robots;
  sensor.T_ref_nominal = NominalPose(model, reference, name);
  if (sensor.T_ref_nominal) sensor.tolerance = SensorOf(model, name)->tolerance;
  sensor.T_ref_center = sensor.T_ref_nominal ? *sensor.T_ref_nominal : MedianPose(sample.poses);
  sensor.offsets = OffsetsFrom(sensor.T_ref_center, sample.poses);
  FillSpreads(sensor);
  return sensor;
}

// The robots of each sensor share the odds with those of all others.
double LimitOfOne(const std::map<SensorId, Sample>& samples) {
  std::size_t looks = 0;
  for (const auto& [sensor, sample] : samples)
    if (sample.robots.size() >= kPopulationMin) looks += sample.robots.size();
  return kPopulationAlpha / static_cast<double>(std::max<std::size_t>(looks, 1));
}

std::string WhyTooFew(const RigModel& model, std::size_t robots) {
  return (robots == 0   ? "No robot"
          : robots == 1 ? "One robot"
                        : std::to_string(robots) + " robots") +
         " of rig model " + model.name +
         (robots == 1   ? " has"
          : robots == 0 ? " has"
                        : " have") +
         " a calibration in use; " + std::to_string(kPopulationMin) + " are needed to tell how they scatter.";
}

}  // namespace

Population DescribePopulation(const RigModel& model, const SensorId& reference, std::vector<RobotPlaces> robots) {
  std::sort(robots.begin(), robots.end(), [](const RobotPlaces& x, const RobotPlaces& y) { return x.robot < y.robot; });
  Population population;
  population.rig_model = model.name;
  population.reference = reference;
  for (const RobotPlaces& robot : robots) population.robots.push_back(robot.robot);
  if (robots.size() < kPopulationMin) population.why_not = WhyTooFew(model, robots.size());
  const std::map<SensorId, Sample> samples = SamplesOf(robots);
  const double limit = LimitOfOne(samples);
  for (const auto& [name, sample] : samples) {
    if (sample.robots.size() < kPopulationMin) {
      population.too_few.emplace_back(name, sample.robots.size());
      continue;
    }
    population.sensors.push_back(Describe(name, sample, model, reference));
    FillOutliers(sample, limit, population.sensors.back());
  }
  return population;
}

}  // namespace rigcal::fleet

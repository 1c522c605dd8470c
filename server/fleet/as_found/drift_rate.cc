#include <algorithm>
#include <cmath>
#include <tuple>

#include "server/fleet/as_found/as_found.h"

namespace rigcal::fleet {
namespace {

constexpr double kThirtyDays_ns = 30.0 * 86'400e9;
constexpr std::size_t kVisitsForRate = 3;

// Where one visit has a sensor, from where it is now.
struct PlaceAt {
  Stamp at;
  Vector6d place = Vector6d::Zero(), variance = Vector6d::Zero();
};

std::vector<PlaceAt> PlacesOf(const SensorId& sensor, const SensorId& frame, const std::vector<VisitPoses>& visits,
                              const KnownPoses& now) {
  std::vector<PlaceAt> places;
  const std::optional<Se3> T_frame_now = PlaceIn(frame, sensor, now);
  if (!T_frame_now) return places;
  const Vector6d scatter = ScatterSeenFrom(frame, sensor, now);
  for (const VisitPoses& visit : visits) {
    if (visit.poses.Find(sensor) == nullptr || visit.poses.Find(frame) == nullptr) continue;
    const PosesSeen seen = SeenFrom(frame, {sensor}, visit.poses);
    places.push_back({visit.captured_at, (T_frame_now->Inverse() * seen.T_frame_sensor.front()).Log(),
                      seen.covariance.diagonal() + scatter});
  }
  return places;
}

// Slope of one axis and its sigma, in units of time of `times`; nothing where all are of one time.
std::optional<std::pair<double, double>> LineThrough(const std::vector<PlaceAt>& places,
                                                     const std::vector<double>& times, int axis) {
  double sum = 0.0, mean = 0.0, spread = 0.0, slope = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double weight = 1 / places[k].variance(axis);
    sum += weight;
    mean += weight * times[k];
  }
  mean /= sum;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double weight = 1 / places[k].variance(axis), at = times[k] - mean;
    spread += weight * at * at;
    slope += weight * at * places[k].place(axis);
  }
  if (!(spread > 0) || !std::isfinite(slope / spread)) return std::nullopt;
  return std::pair(slope / spread, 1 / std::sqrt(spread));
}

std::optional<DriftRate> RateOf(const std::vector<PlaceAt>& places) {
  if (places.size() < kVisitsForRate) return std::nullopt;
  const auto [first, last] =
      std::minmax_element(places.begin(), places.end(), [](const PlaceAt& x, const PlaceAt& y) { return x.at < y.at; });
  if (first->at == last->at) return std::nullopt;
  DriftRate rate{static_cast<int>(places.size()), first->at, last->at};
  std::vector<double> times;
  for (const PlaceAt& place : places) times.push_back(static_cast<double>(place.at.ns - first->at.ns) / kThirtyDays_ns);
  for (int axis = 0; axis < 6; ++axis) {
    const auto line = LineThrough(places, times, axis);
    if (!line) return std::nullopt;
    std::tie(rate.per_30_days(axis), rate.sigma_per_30_days(axis)) = *line;
  }
  return rate;
}

}  // namespace

void AddDriftRates(const std::vector<VisitPoses>& visits, const KnownPoses& now, AsFound& found) {
  for (SensorFound& sensor : found.sensors)
    if (sensor.state == FoundState::kUnchanged || sensor.state == FoundState::kDrifted)
      sensor.rate = RateOf(PlacesOf(sensor.sensor, found.relative_to, visits, now));
}

}  // namespace rigcal::fleet

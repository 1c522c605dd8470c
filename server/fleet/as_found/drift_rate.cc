#include <algorithm>
#include <cmath>

#include "server/fleet/as_found/as_found.h"

namespace rigcal::fleet {
namespace {

constexpr double kThirtyDays_ns = 30.0 * 86'400e9;
constexpr std::size_t kVisitsForRate = 3;

// Where one visit has a sensor, from where it is now.
struct PlaceAt {
  Stamp at;
  Vector6d place = Vector6d::Zero(), variance = Vector6d::Zero();
  Vector6d own = Vector6d::Zero();  // of `variance`, what the visit errs by
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
                      seen.covariance.diagonal() + scatter, seen.covariance.diagonal()});
  }
  return places;
}

// A straight line, by weighted least squares: what is to be at `time` is place + slope (time - mean).
struct Line {
  double mean = 0.0, place = 0.0, slope = 0.0;
  double spread = 0.0;  // sum of weight (time - mean)^2
};
Line LineThrough(const std::vector<PlaceAt>& places, const std::vector<double>& times, int axis) {
  Line line;
  double sum = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double weight = 1 / places[k].variance(axis);
    sum += weight;
    line.mean += weight * times[k];
    line.place += weight * places[k].place(axis);
  }
  line.mean /= sum, line.place /= sum;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double weight = 1 / places[k].variance(axis), at = times[k] - line.mean;
    line.spread += weight * at * at;
    line.slope += weight * at * places[k].place(axis);
  }
  line.slope /= line.spread;
  return line;
}

// What visits scatter by about the line, in their own variances; no less than they err by.
double ScatterAbout(const Line& line, const std::vector<PlaceAt>& places, const std::vector<double>& times, int axis) {
  double squares = 0.0, own = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double off = places[k].place(axis) - line.place - line.slope * (times[k] - line.mean);
    squares += off * off / places[k].variance(axis);
    own += places[k].own(axis) / places[k].variance(axis);
  }
  const auto count = static_cast<double>(places.size());
  return std::max(squares / (count - 2), own / count);
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
    const Line line = LineThrough(places, times, axis);
    if (!(line.spread > 0) || !std::isfinite(line.slope)) return std::nullopt;
    rate.per_30_days(axis) = line.slope;
    rate.sigma_per_30_days(axis) = std::sqrt(ScatterAbout(line, places, times, axis) / line.spread);
  }
  return rate;
}

}  // namespace

void AddDriftRates(const std::vector<VisitPoses>& visits, const KnownPoses& now, AsFound& found) {
  for (SensorFound& sensor : found.sensors)
    if (IsTested(sensor)) sensor.rate = RateOf(PlacesOf(sensor.sensor, found.relative_to, visits, now));
}

}  // namespace rigcal::fleet

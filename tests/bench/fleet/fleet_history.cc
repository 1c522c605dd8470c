// Dated calibrations of one rig read as its visits: what each finds of those before it. Prints one JSON object.
// usage: fleet_history SIGMA_MM SIGMA_DEG < VISITS   (of every axis of a visit's poses, which err apart)
//
// VISITS, oldest first: a line "visit DATE", then for each sensor "SENSOR x y z qx qy qz qw" in metres in one frame of
// all of them; the first sensor of the first visit is the reference.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <sstream>

#include "tests/bench/fleet/robot_history.h"

namespace rigcal::drawn_fleet {
namespace {

constexpr std::size_t kSensorsMax = 64;

struct DatedVisit {
  Stamp at;
  std::vector<std::pair<SensorId, Se3>> poses;
};

std::optional<std::vector<DatedVisit>> Read(std::istream& lines) {
  std::vector<DatedVisit> visits;
  for (std::string line, word; std::getline(lines, line);) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "visit") {
      std::string date;
      words >> date;
      const auto at = ParseIso(date);
      if (!at) return std::nullopt;
      visits.push_back({*at, {}});
      continue;
    }
    const auto sensor = SensorId::Parse(word);
    Se3 T;
    Eigen::Vector4d q;
    if (!sensor || visits.empty() || visits.back().poses.size() >= kSensorsMax) return std::nullopt;
    if (!(words >> T.p_m.x() >> T.p_m.y() >> T.p_m.z() >> q.x() >> q.y() >> q.z() >> q.w()) || q.norm() < 0.5)
      return std::nullopt;
    T.q = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z());
    visits.back().poses.emplace_back(*sensor, T.Normalized());
  }
  return visits;
}

SessionEstimate EstimateOf(const DatedVisit& visit, std::size_t number, const SensorId& reference, double sigma_m,
                           double sigma_rad) {
  SessionEstimate estimate;
  char name[65];
  std::snprintf(name, sizeof name, "%064zx", number + 1);
  estimate.session = SessionId(name);
  estimate.reference = reference;
  Se3 T_reference;
  for (const auto& [sensor, T] : visit.poses)
    if (sensor == reference) T_reference = T;
  for (const auto& [sensor, T] : visit.poses)
    estimate.poses.push_back({sensor, sensor == reference ? Se3{} : T_reference.Inverse() * T, 0.0});
  std::sort(estimate.poses.begin(), estimate.poses.end(),
            [](const auto& x, const auto& y) { return x.sensor < y.sensor; });
  const auto sensors = static_cast<Eigen::Index>(estimate.poses.size()) - 1;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  estimate.covariance = Eigen::VectorXd(variance.replicate(sensors, 1)).asDiagonal();
  return estimate;
}

void Print(const AsFound& found, const DatedVisit& visit) {
  std::string accused;
  double worst = 0.0;
  for (const SensorFound& sensor : found.sensors) {
    worst = std::max(worst, InSigmas(sensor));
    if (sensor.state == FoundState::kDrifted) accused += (accused.empty() ? "\"" : ", \"") + sensor.sensor.str() + "\"";
  }
  std::printf(
      "{\"visit\": \"%s\", \"visits_in_use\": %d, \"tests\": %d, \"accused\": [%s], \"worst_sigmas\": %.3f, "
      "\"smallest_mm\": %.3f, "
      "\"smallest_deg\": %.4f}",
      ToIso(visit.at).c_str(), found.visits, found.tests, accused.c_str(), worst, 1e3 * SmallestSeen_m(found),
      57.29577951308232 * SmallestSeen_rad(found));
}

int Run(int count, char** arguments) {
  const auto visits = Read(std::cin);
  if (count != 3 || !visits || visits->empty() || visits->front().poses.size() < 2) {
    std::fprintf(stderr, "usage: fleet_history SIGMA_MM SIGMA_DEG < VISITS\n");
    return 2;
  }
  const SensorId reference = visits->front().poses.front().first;
  const double sigma_m = 1e-3 * std::atof(arguments[1]), sigma_rad = std::atof(arguments[2]) / 57.29577951308232;
  RobotHistory history(RobotId("rig"), reference);
  std::printf("{\"visits\": [");
  for (std::size_t i = 0; i < visits->size(); ++i) {
    SessionEstimate estimate = EstimateOf((*visits)[i], i, reference, sigma_m, sigma_rad);
    if (history.HasRevision()) {
      std::printf("%s", i > 1 ? ", " : "");
      Print(history.Test(estimate), (*visits)[i]);
    }
    history.Take(std::move(estimate), (*visits)[i].at);
  }
  std::printf("]}\n");
  return 0;
}

}  // namespace
}  // namespace rigcal::drawn_fleet

int main(int count, char** arguments) { return rigcal::drawn_fleet::Run(count, arguments); }

// What the paper argues with (section III-B): the pose between two sensors chained along a path, calibrated directly,
// or taken from the graph of all edges; each against the truth.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/paper/joint_errors.h"
#include "tests/paper/page.h"
#include "tests/paper/visit.h"

namespace rigcal::paper {

enum Way { kChained, kDirect, kGraph };
constexpr std::size_t kWays = 3;
constexpr std::array<const char*, kWays> kWayNames = {"chained", "direct", "graph"};

struct WayErrors {
  std::vector<double> error_m, error_rad;           // one per visit
  double predicted_m2 = 0.0, predicted_rad2 = 0.0;  // means of the squares, from the edges' joint covariance
};

struct Route {
  std::vector<SensorId> sensors;  // of the chain: first and last are the pair
  std::string direct_method;
  std::array<WayErrors, kWays> ways;
};

// All routes together.
struct WaySum {
  double rms_m = 0.0, rms_rad = 0.0;
  double predicted_rms_m = 0.0, predicted_rms_rad = 0.0;
  double variance_m_ratio = 0.0, variance_rad_ratio = 0.0;  // of the mean square over its prediction
};

struct ChainExperiment {
  std::size_t visits = 0;
  std::vector<Route> routes;
  std::array<WaySum, kWays> sums;
};

// Routes of the MARS Mapper. A visit in which an edge of a route failed is left out of that route.
[[nodiscard]] ChainExperiment RunChainExperiment(const std::vector<Visit>& visits);
[[nodiscard]] Section ChainSection(const ChainExperiment& experiment);

[[nodiscard]] double Rms(const std::vector<double>& values);

}  // namespace rigcal::paper

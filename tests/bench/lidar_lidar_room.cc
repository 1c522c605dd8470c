// Two lidars in a room of flat panels, several captures and a known truth, by NDT and polished:
//   lidar_lidar_room CAPTURES SEED
// Prints one JSON object. "held_out_captures_...": of each capture by the pose without it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/calib/lidar_lidar.h"
#include "tests/unit/calib_virtual_room.h"

namespace rigcal {
namespace {

void Print(const char* name, const Edge& edge, const Se3& truth, const char* end) {
  const bool good = edge.state == EdgeState::kGood;
  const Vector6d error = (truth.Inverse() * edge.T_a_b).Log();
  const double in_sigmas =
      good ? (error.array().abs() / edge.uncertainty.covariance.diagonal().array().sqrt()).maxCoeff() : 0.0;
  std::printf("\"%s\": {\"good\": %s, \"error_m\": %.9g, \"error_rad\": %.9g, \"worst_in_sigmas\": %.4g", name,
              good ? "true" : "false", error.head<3>().norm(), error.tail<3>().norm(), in_sigmas);
  for (const auto& [figure, value] : edge.figures) std::printf(", \"%s\": %.9g", figure.c_str(), value);
  std::printf("}%s", end);
}

int Measure(int captures, unsigned seed) {
  const calib::VirtualRoom room;
  calib::LidarLidarProblem problem = calib::RecordedIn(room, captures, seed);
  std::printf("{\"range_noise_m\": %.9g, ", room.beams_a.noise_m);
  const Edge ndt = calib::EstimateLidarLidarEdge(problem);
  Print("ndt", ndt, room.T_a_b, ", ");
  problem.polish = true;
  const Edge polished = calib::EstimateLidarLidarEdge(problem);
  Print("polished", polished, room.T_a_b, "}\n");
  return ndt.state == EdgeState::kGood && polished.state == EdgeState::kGood ? 0 : 1;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: lidar_lidar_room CAPTURES SEED\n");
    return 2;
  }
  return rigcal::Measure(std::max(1, std::atoi(argv[1])), static_cast<unsigned>(std::atoi(argv[2])));
}

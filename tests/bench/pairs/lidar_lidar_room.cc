// Two lidars in a room of flat panels, several captures and a known truth, by NDT and polished:
//   lidar_lidar_room CAPTURES SEED
// "held_out_captures_...": of each capture by the pose without it. Or one capture each of many seeds, with clouds of
// this range noise: errors and sigmas told, and of NDT's finest level at its own optimum, with the sigmas of its
// Hessian:
//   lidar_lidar_room --one-capture RANGE_NOISE_M SEEDS
// Prints one JSON object.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "tests/unit/calib/virtual_room.h"

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

struct InSigmas {
  int count = 0;
  double squares = 0, worst = 0, sum_m2 = 0;

  void Add(const Vector6d& error, const Matrix6d& information) {
    ++count;
    squares += error.dot(information * error) / 6;
    sum_m2 += error.head<3>().squaredNorm();
    const Vector6d sigma = Matrix6d(information.inverse()).diagonal().cwiseSqrt();
    worst = std::max(worst, (error.array().abs() / sigma.array()).maxCoeff());
  }
  void Print(const char* name) const {
    const int at_least_one = std::max(1, count);
    std::printf(", \"%s\": {\"count\": %d, \"rms_m\": %.4g, \"mean_square\": %.4g, \"worst\": %.4g}", name, count,
                std::sqrt(sum_m2 / at_least_one), squares / at_least_one, worst);
  }
};

// Second derivatives of NDT's negative log likelihood (Magnusson 2009, equation 6.13), for T_map_moving Exp(xi), with
// the neighbours and weights that the score has here. Magnusson's d1 is its scale; 55 % are taken to be outliers.
Matrix6d NdtHessian(const calib::NdtTerm& term, const Se3& T_map_moving) {
  constexpr double kStep = 1e-4;
  Matrix6d H;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    H.col(i) = (calib::ScoreOf({term}, T_map_moving * Se3::Exp(step)).gradient -
                calib::ScoreOf({term}, T_map_moving * Se3::Exp(-step)).gradient) /
               (2 * kStep);
  }
  const double inliers = 10 * 0.45, outliers = 0.55 / std::pow(term.map->voxel_m, 3);
  return std::log(1 + inliers / outliers) * 0.5 * (H + H.transpose());
}

// Not counted where the Hessian is no information matrix.
void AddNdt(const calib::VirtualRoom& room, const calib::LidarLidarProblem& problem, const Edge& edge, InSigmas& ndt) {
  const calib::LidarLidarWork work = calib::WorkOf(problem, {}, false);
  const calib::NdtTerm finest{&work.clouds.front().maps.back(), &work.clouds.front().points.back()};
  const Se3 start = work.a_is_map ? edge.T_a_b : edge.T_a_b.Inverse();
  const Se3 truth = work.a_is_map ? room.T_a_b : room.T_a_b.Inverse();
  const calib::NdtFit fit = calib::FitNdt({finest}, start, 1e-6);
  const Matrix6d hessian = NdtHessian(finest, fit.T_a_b);
  if (Eigen::LLT<Matrix6d>(hessian).info() == Eigen::Success) ndt.Add((fit.T_a_b.Inverse() * truth).Log(), hessian);
}

int MeasureOneCapture(double noise_m, int seeds) {
  calib::VirtualRoom room;
  room.beams_a.noise_m = room.beams_b.noise_m = noise_m;
  InSigmas told, ndt;
  int model = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const calib::LidarLidarProblem problem = calib::RecordedIn(room, 1, static_cast<unsigned>(seed));
    const Edge edge = calib::EstimateLidarLidarEdge(problem);
    if (edge.state != EdgeState::kGood || edge.uncertainty.rank < 6) continue;
    model += edge.uncertainty.source == UncertaintySource::kModel && edge.uncertainty.blocks.empty() ? 1 : 0;
    told.Add((edge.T_a_b.Inverse() * room.T_a_b).Log(), edge.uncertainty.Omega);
    AddNdt(room, problem, edge, ndt);
  }
  std::printf("{\"range_noise_m\": %.9g, \"seeds\": %d, \"model\": %d", noise_m, seeds, model);
  told.Print("told");
  ndt.Print("ndt_hessian");
  std::printf("}\n");
  return told.count > 0 ? 0 : 1;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc == 4 && std::string_view(argv[1]) == "--one-capture")
    return rigcal::MeasureOneCapture(std::atof(argv[2]), std::max(1, std::atoi(argv[3])));
  if (argc != 3) {
    std::fprintf(stderr,
                 "usage: lidar_lidar_room CAPTURES SEED\n       lidar_lidar_room --one-capture RANGE_NOISE_M SEEDS\n");
    return 2;
  }
  return rigcal::Measure(std::max(1, std::atoi(argv[1])), static_cast<unsigned>(std::atoi(argv[2])));
}

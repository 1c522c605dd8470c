// Measures hand-eye calibration against known truth: hand_eye_simulation SEEDS prints one JSON object.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/calib/motion/hand_eye_work.h"
#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_motion.h"

namespace rigcal::calib {
namespace {

constexpr double kNoise_rad = 0.05 * M_PI / 180;
constexpr PoseNoise kNoise{0.0003, kNoise_rad};

// A drawing that is off by some centimetres and degrees.
Se3 Drawn(const Se3& truth) {
  Vector6d off;
  off << 0.02, -0.01, 0.015, 0.02, -0.03, 0.02;
  return truth * Se3::Exp(off);
}

double AxisError_deg(const MotionReach& reach) {
  return std::acos(std::min(1.0, std::abs(reach.axis_a.z()))) * 180 / M_PI;
}

// Little tilt: what is claimed must hold, and the axis be named.
void WeakMotion(const char* name, Drive drive, int seeds) {
  std::printf("\"%s\": [", name);
  const char* comma = "";
  for (const double ratio : {0.0, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0}) {
    double worst = 0, axis_deg = 0;
    int ranks[7] = {0, 0, 0, 0, 0, 0, 0}, failed = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      const VirtualBody body = Driven(drive, 40, ratio * kNoise_rad, 100 + static_cast<unsigned>(seed));
      HandEyeProblem problem = Tracked(body, kNoise, kNoise, 900 + static_cast<unsigned>(seed));
      if (drive == Drive::kOnTheSpot) problem.T_a_b_nominal = Drawn(body.X);
      const auto result = EstimateHandEye(problem);
      if (!result) {
        ++failed;
        continue;
      }
      ++ranks[result->uncertainty.rank];
      worst = std::max(worst, WorstSigmas(body.X, result->estimate.T_a_b, result->uncertainty));
      if (result->uncertainty.rank < 6) axis_deg = std::max(axis_deg, AxisError_deg(result->estimate.reach));
    }
    std::printf(
        "%s{\"ratio\": %.1f, \"worst_sigmas\": %.3f, \"axis_deg\": %.3f, \"rank4\": %d, \"rank5\": %d, \"rank6\": "
        "%d, \"failed\": %d}",
        comma, ratio, worst, axis_deg, ranks[4], ranks[5], ranks[6], failed);
    comma = ", ";
  }
  std::printf("], ");
}

struct Statistics {
  int count = 0, failed = 0, covered = 0;
  double sum_m2 = 0, sum_rad2 = 0, worst = 0, bound_m2 = 0, bound_rad2 = 0;

  void Add(const Se3& truth, const tl::expected<HandEyeResult, Diagnosis>& result) {
    ++count;
    if (!result || result->uncertainty.rank < 6) {
      ++failed;
      return;
    }
    const Vector6d e = (truth.Inverse() * result->estimate.T_a_b).Log();
    sum_m2 += e.head<3>().squaredNorm();
    sum_rad2 += e.tail<3>().squaredNorm();
    worst = std::max(worst, WorstSigmas(truth, result->estimate.T_a_b, result->uncertainty));
    const Vector6d back = (result->estimate.T_a_b.Inverse() * truth).Log();
    if (back.dot(result->uncertainty.Omega * back) <= HotellingLimit(result->uncertainty.dof + 1)) ++covered;
  }
  void Print(const char* name) const {
    const double good = std::max(1, count - failed);
    std::printf(
        "\"%s\": {\"count\": %d, \"failed\": %d, \"rms_mm\": %.5f, \"rms_deg\": %.6f, \"bound_mm\": %.5f, "
        "\"bound_deg\": %.6f, \"worst_sigmas\": %.3f, \"covered_ratio\": %.4f}, ",
        name, count, failed, 1e3 * std::sqrt(sum_m2 / good), 180 / M_PI * std::sqrt(sum_rad2 / good),
        1e3 * std::sqrt(bound_m2 / count), 180 / M_PI * std::sqrt(bound_rad2 / count), worst, covered / good);
  }
};

// What a perfect estimator would be good for: the information at the truth, under the noise that was put in.
void AddBound(const HandEyeProblem& exact, const VirtualBody& body, const PoseNoise& tracker, double sigma_px,
              Statistics& statistics) {
  auto work = CollectMotion(exact);
  if (!work) return;
  const auto scale = [&](const std::optional<CameraMotion>& camera) {
    return camera ? sigma_px * sigma_px / std::max(camera->camera.variance_px2, 1e-6) : 1.0;
  };
  work->factor_a = {scale(work->camera_a), scale(work->camera_a)};
  work->factor_b = {scale(work->camera_b), scale(work->camera_b)};
  work->choices.assign(work->captures.size(), {});
  for (MotionCandidates& capture : work->candidates)
    for (auto* side : {&capture.a, &capture.b}) {
      const bool camera = (side == &capture.a ? work->camera_a : work->camera_b).has_value();
      Vector6d variances;
      variances << Eigen::Vector3d::Constant(std::pow(tracker.translation_m, 2)),
          Eigen::Vector3d::Constant(std::pow(tracker.rotation_rad, 2));
      SidePose& pose = side->front().pose;
      pose.covariance =
          camera ? Matrix6d(pose.covariance * (side == &capture.a ? work->factor_a : work->factor_b).translation)
                 : Matrix6d(variances.asDiagonal());
    }
  MotionProblem problem = ProblemOf(work->candidates, work->choices);
  SetShared(*work, {}, problem);
  const auto fit = FitOf(problem, StateFrom(problem, body.X, body.Z));
  if (!fit) return;
  statistics.bound_m2 += fit->C_X.topLeftCorner(3, 3).trace();
  statistics.bound_rad2 += fit->C_X.bottomRightCorner(3, 3).trace();
}

void General(int seeds) {
  Statistics tracked, camera, two, estimated;
  VirtualView view, exact = view;
  exact.sigma_px = 0;
  const PoseNoise tracker{0.0002, kNoise_rad};
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(i);
    const VirtualBody driven = Driven(Drive::kFree, 40, 0.3, seed);
    tracked.Add(driven.X, EstimateHandEye(Tracked(driven, kNoise, kNoise, seed + 5000)));
    const VirtualBody body = Looking(view, 40, 0.25, 0.09, seed);
    camera.Add(body.X, EstimateHandEye(TrackerAndCamera(body, view, tracker, 0, seed)));
    AddBound(TrackerAndCamera(body, exact, {}, 0, seed), body, tracker, view.sigma_px, camera);
    if (i % 4 != 0) continue;
    two.Add(body.X, EstimateHandEye(TwoCameras(body, view, true, seed)));
    AddBound(TwoCameras(body, exact, true, seed), body, {}, view.sigma_px, two);
    estimated.Add(body.X, EstimateHandEye(TwoCameras(body, view, false, seed)));
    AddBound(TwoCameras(body, exact, false, seed), body, {}, view.sigma_px, estimated);
  }
  tracked.Print("two_trackers");
  camera.Print("tracker_camera");
  two.Print("two_cameras_given");
  estimated.Print("two_cameras_estimated");
}

// A board that looks alike when turned, numbered turned in 30 % of the views; and small, nearly frontal ones.
void Turned(int seeds) {
  double worst_mm = 0, worst_deg = 0, small_worst_sigmas = 0, small_mm = 0;
  int failed = 0;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(i);
    VirtualView view;
    view.board.cols = 9, view.board.rows = 7;
    const VirtualBody body = Looking(view, 40, 0.25, 0.09, seed);
    const auto plain = EstimateHandEye(TrackerAndCamera(body, view, {0.0002, kNoise_rad}, 0, seed));
    const auto turned = EstimateHandEye(TrackerAndCamera(body, view, {0.0002, kNoise_rad}, 0.3, seed));
    if (!plain || !turned) {
      ++failed;
      continue;
    }
    const Vector6d e = (plain->estimate.T_a_b.Inverse() * turned->estimate.T_a_b).Log();
    worst_mm = std::max(worst_mm, 1e3 * e.head<3>().norm());
    worst_deg = std::max(worst_deg, 180 / M_PI * e.tail<3>().norm());
    view.board.square_m = 0.012;  // 60 to 80 px across
    const auto tiny =
        EstimateHandEye(TrackerAndCamera(Looking(view, 40, 0.25, 0.09, seed), view, {0.0002, kNoise_rad}, 0.3, seed));
    if (!tiny) {
      ++failed;
      continue;
    }
    small_worst_sigmas = std::max(small_worst_sigmas, WorstSigmas(body.X, tiny->estimate.T_a_b, tiny->uncertainty));
    small_mm = std::max(small_mm, 1e3 * (tiny->estimate.T_a_b.p_m - body.X.p_m).norm());
  }
  std::printf(
      "\"turned\": {\"moved_mm\": %.8f, \"moved_deg\": %.8f, \"failed\": %d, \"small_worst_sigmas\": %.3f, "
      "\"small_worst_mm\": %.3f}, ",
      worst_mm, worst_deg, failed, small_worst_sigmas, small_mm);
}

void Streams(int seeds) {
  Statistics statistics;
  double offset_ms = 0, offset_sigmas = 0;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(i);
    const VirtualBody body = Driven(Drive::kFree, 1, 0.3, seed);
    const auto result = EstimateHandEye(Streamed(body, {0.002, 0.002}, 60, 123.456789, seed));
    statistics.Add(body.X, result);
    if (!result) continue;
    const double error_s = std::abs(*result->estimate.offset_s - 123.456789);
    offset_ms = std::max(offset_ms, 1e3 * error_s);
    offset_sigmas = std::max(offset_sigmas, error_s / *result->estimate.offset_sigma_s);
  }
  statistics.Print("streams");
  std::printf("\"offset_worst_ms\": %.4f, \"offset_worst_sigmas\": %.3f, ", offset_ms, offset_sigmas);
}

int Measure(int seeds) {
  const auto start = std::chrono::steady_clock::now();
  std::printf("{");
  WeakMotion("planar", Drive::kFloor, seeds);
  WeakMotion("on_the_spot", Drive::kOnTheSpot, seeds);
  General(2 * seeds);
  Turned(std::max(1, seeds / 4));
  Streams(std::max(1, seeds / 8));
  std::printf("\"seconds\": %.1f}\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}

}  // namespace
}  // namespace rigcal::calib

int main(int argc, char** argv) {
  const int seeds = argc == 2 ? std::atoi(argv[1]) : 0;
  if (seeds < 1) {
    std::fprintf(stderr, "usage: hand_eye_simulation SEEDS\n");
    return 2;
  }
  return rigcal::calib::Measure(seeds);
}

// Measures eye-to-hand calibration against known truth: eye_to_hand_simulation SEEDS prints one JSON object.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/calib/eye_to_hand/exchanged_roles.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_cell.h"

namespace rigcal::calib {
namespace {

constexpr int kCaptures = 25;
constexpr PoseNoise kArm{0.0002, 0.0005};

struct Tally {
  int count = 0, failed = 0, covered = 0;
  double sum_m2 = 0, sum_rad2 = 0, bound_m2 = 0, bound_rad2 = 0, worst = 0;

  void Add(const Se3& truth, const OrDiagnosis<EyeToHandResult>& result) {
    ++count;
    if (!result || result->uncertainty.rank < 6) {
      ++failed;
      return;
    }
    const Vector6d e = (result->estimate.T_a_b.Inverse() * truth).Log();
    sum_m2 += e.head<3>().squaredNorm();
    sum_rad2 += e.tail<3>().squaredNorm();
    worst = std::max(worst, WorstSigmas(truth, result->estimate.T_a_b, result->uncertainty));
    covered += e.dot(result->uncertainty.Omega * e) <= HotellingLimit(result->uncertainty.dof + 1) ? 1 : 0;
  }
  void Print(const char* name) const {
    const double good = std::max(1, count - failed);
    std::printf(
        "\"%s\": {\"failed\": %d, \"covered_ratio\": %.4f, \"worst_sigmas\": %.3f, \"rms_mm\": %.5f, "
        "\"rms_deg\": %.6f, \"bound_mm\": %.5f, \"bound_deg\": %.6f}, ",
        name, failed, covered / good, worst, 1e3 * std::sqrt(sum_m2 / good), 180 / M_PI * std::sqrt(sum_rad2 / good),
        1e3 * std::sqrt(bound_m2 / count), 180 / M_PI * std::sqrt(bound_rad2 / count));
  }
};

// What a perfect estimator would be good for: the information at the truth under the noise that was put in, the robot's
// at its flange, F Exp(n) = (Exp(-n) F^-1)^-1, so -Ad(A^-1) n of the exchanged pose A.
void AddBound(const HandEyeProblem& exact, const VirtualCell& cell, double sigma_px, Tally& tally) {
  const ExchangedRoles roles = WithRolesExchanged(exact);
  auto work = CollectMotion(roles.hand_eye);
  if (!work) return;
  const double factor = sigma_px * sigma_px / std::max(work->camera_b->camera.variance_px2, 1e-6);
  work->factor_b = {factor, factor};
  work->choices.assign(work->captures.size(), {});
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(std::pow(kArm.translation_m, 2)),
      Eigen::Vector3d::Constant(std::pow(kArm.rotation_rad, 2));
  for (MotionCandidates& capture : work->candidates) {
    SidePose& arm = capture.a.front().pose;
    const Matrix6d M = Adjoint(arm.T_world_sensor.Inverse());
    arm.covariance = M * variances.asDiagonal() * M.transpose();
    capture.b.front().pose.covariance *= factor;
  }
  MotionProblem problem = ProblemOf(work->candidates, work->choices);
  SetShared(*work, {}, problem);
  const auto fit =
      FitOf(problem, StateFrom(problem, roles.T_base_anchor.Inverse() * cell.T_base_cam, cell.T_flange_board));
  if (!fit) return;
  tally.bound_m2 += fit->C_X.topLeftCorner(3, 3).trace();
  tally.bound_rad2 += fit->C_X.bottomRightCorner(3, 3).trace();
}

void Cells(const char* name, bool given, int seeds) {
  Tally tally;
  const VirtualView view;
  VirtualView exact = view;
  exact.sigma_px = 0;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(i);
    const VirtualCell cell = Celled(view, Arm::kAll, kCaptures, seed);
    tally.Add(cell.T_base_cam, EstimateEyeToHand(ArmAndCamera(cell, view, kArm, given, 7000 + seed)));
    AddBound(ArmAndCamera(cell, exact, {}, given, seed), cell, view.sigma_px, tally);
  }
  tally.Print(name);
}

// What motion leaves open is not claimed.
void Poor(const char* name, Arm arm, int rank, int seeds) {
  const VirtualView view;
  double worst = 0;
  int other_rank = 0;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(300 + i);
    const VirtualCell cell = Celled(view, arm, kCaptures, seed);
    HandEyeProblem problem = ArmAndCamera(cell, view, kArm, true, seed);
    problem.T_a_b_nominal = cell.T_base_cam * Se3::Exp(0.002 * Vector6d::Ones());
    const auto result = EstimateEyeToHand(problem);
    if (!result || result->uncertainty.rank != rank)
      ++other_rank;
    else
      worst = std::max(worst, WorstSigmas(cell.T_base_cam, result->estimate.T_a_b, result->uncertainty));
  }
  std::printf("\"%s\": {\"other_rank\": %d, \"worst_sigmas\": %.3f}, ", name, other_rank, worst);
}

}  // namespace
}  // namespace rigcal::calib

int main(int argc, char** argv) {
  using namespace rigcal::calib;
  const int seeds = argc == 2 ? std::atoi(argv[1]) : 0;
  if (seeds < 1) {
    std::fprintf(stderr, "usage: eye_to_hand_simulation SEEDS\n");
    return 2;
  }
  const auto start = std::chrono::steady_clock::now();
  std::printf("{");
  Cells("given", true, seeds);
  Cells("estimated", false, std::max(1, seeds / 2));
  Poor("one_axis", Arm::kOneAxis, 5, std::max(1, seeds / 2));
  Poor("first_joint", Arm::kFirstJoint, 4, std::max(1, seeds / 2));
  Poor("no_turns", Arm::kNoTurns, 3, std::max(1, seeds / 2));
  std::printf("\"seconds\": %.1f}\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}

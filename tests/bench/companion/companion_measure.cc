// Two operators before the same rigs, seed by seed: one holds the board where the companion says, give or take a hand's
// breadth; the other anywhere where two cameras see it, at any distance, tilted anyhow by up to 45 degrees. A session
// ends at the first capture with which the refinement of the session tells every pose within the default tolerance.
// Beside it, when every pair has the captures that the server wants of it. Prints JSON.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>

#include "client/companion/standing.h"
#include "client/sim/rig/random.h"
#include "server/base/process/parallel_for.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/joint/estimate_session.h"
#include "server/formats/json/json_values.h"
#include "server/model/approval/policy.h"
#include "tests/bench/companion/held_board.h"

namespace rigcal {
namespace {

namespace placement = calib::placement;

constexpr int kCapturesMax = 60;
constexpr double kHand_m = 0.04, kHand_rad = 0.06;  // how well somebody keeps to the advice, per axis

struct RigCase {
  int cameras;
  double turn_deg, apart_m;
  bool lenses_given;
};
// Five that look all round, overlapping at their borders; three side by side whose lenses are to be estimated.
constexpr RigCase kCases[] = {{5, 45, 0.0, true}, {3, 25, 0.2, false}};

// At the end of a session.
struct Told {
  std::size_t captures = kCapturesMax;
  std::size_t paired = kCapturesMax;  // with which every pair that ties the rig has as many as the server wants
  bool has_ended = false;
  double sigma_m = 0.0;               // the largest that is told
  int errors = 0, errors_within = 0;  // numbers of poses; within three of their sigmas from the truth
};

bool IsWithin(const SessionEstimate& estimate, std::size_t cameras) {
  if (!estimate.why_not.empty() || estimate.poses.size() != cameras) return false;
  for (Eigen::Index i = 0; i < estimate.covariance.rows(); ++i)
    if (std::sqrt(estimate.covariance(i, i)) > (i % 6 < 3 ? kDefaultTolerance.m : kDefaultTolerance.rad)) return false;
  return true;
}

SessionEstimate EstimateOf(const HeldBoard& held, std::size_t captures) {
  const auto views = held.ViewsOf(captures);
  if (views) return calib::joint::EstimateSession(*views);
  SessionEstimate none;
  none.why_not.push_back({"no_lens", "a camera has no estimate", ""});
  return none;
}

void CompareWithTruth(const HeldBoard& held, const SessionEstimate& estimate, Told& told) {
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    const int row = RowOf(estimate, i);
    if (row < 0) continue;
    const Vector6d error =
        (held.Experiment().T_ref_sensor(estimate.poses[i].sensor).Inverse() * estimate.poses[i].T_ref_sensor).Log();
    for (int axis = 0; axis < 6; ++axis) {
      const double sigma = std::sqrt(estimate.covariance(row + axis, row + axis));
      ++told.errors;
      told.errors_within += std::abs(error[axis]) <= 3 * sigma ? 1 : 0;
      if (axis < 3) told.sigma_m = std::max(told.sigma_m, sigma);
    }
  }
}

// kCapturesMax: never.
std::size_t PairedAt(const HeldBoard& held) {
  constexpr int kWanted = static_cast<int>(calib::kCapturesEnough);
  placement::PairTies ties(held.Experiment().rig.sensors.size());
  for (std::size_t k = 0; k < held.Captures(); ++k) {
    placement::PlannedCapture capture;
    for (const std::size_t camera : held.SeeingIn(k)) capture.looks.push_back({camera, {}, {}});
    ties.Add(capture);
    const std::vector<int> tied = ties.TiedBy(0, kWanted);
    if (*std::min_element(tied.begin(), tied.end()) >= kWanted) return k + 1;
  }
  return kCapturesMax;
}

// Sigmas fall with captures, so the first that will do is found by halving.
Told EndOf(const HeldBoard& held) {
  Told told;
  told.paired = PairedAt(held);
  const std::size_t cameras = held.Experiment().rig.sensors.size();
  std::size_t least = 1, most = held.Captures();
  told.has_ended = IsWithin(EstimateOf(held, most), cameras);
  if (!told.has_ended) return told;
  while (least < most) {
    const std::size_t middle = (least + most) / 2;
    if (IsWithin(EstimateOf(held, middle), cameras))
      most = middle;
    else
      least = middle + 1;
  }
  told.captures = most;
  CompareWithTruth(held, EstimateOf(held, most), told);
  return told;
}

Se3 ByHand(const Target& board, const Se3& T_camera_board, sim::Random& random) {
  Vector6d off;
  off << kHand_m * random.Normals<3>(), kHand_rad * random.Normals<3>();
  const Se3 T_board_middle{CentreOf(board), Eigen::Quaterniond::Identity()};
  return (T_camera_board * T_board_middle * Se3::Exp(off) * T_board_middle.Inverse()).Normalized();
}

struct Advised {
  Told told;
  std::vector<double> sigma_so_far_m;  // the largest position sigma, by how many captures it is told of
  double advice_ms = 0.0;

  // Over what the companion expected of as many captures; 0 where the session did not end.
  [[nodiscard]] double ToldOverSoFar() const {
    const bool is_known = told.has_ended && told.captures < sigma_so_far_m.size();
    return is_known ? told.sigma_m / sigma_so_far_m[told.captures] : 0.0;
  }
};

double LargestSigma_m(const placement::PlacementAdvice& advice) {
  double largest_m = 0;
  for (const placement::PoseSoFar& pose : advice.poses)
    largest_m = std::max(largest_m, pose.sigma.head<3>().maxCoeff());
  return largest_m;
}

// Before any picture of a lens that is to be estimated nothing can be planned: somewhere that two may see it.
void HoldSomewhere(HeldBoard& held) {
  const SensorId& first = held.Experiment().rig.sensors.front().id;
  held.Hold(first, placement::PoseOf({0.1, 0, 2 * PatternSize_m(held.Board()).norm(), 0.4, 0}, held.Board()));
}

// Goes on until the companion says that it is enough.
Advised FollowAdvice(HeldBoard& held, std::uint64_t seed) {
  sim::Random random(sim::KeyOf(seed, "advised hand"));
  Advised advised;
  while (held.Captures() < kCapturesMax) {
    companion::Captured captured = held.Captured();
    const auto began = std::chrono::steady_clock::now();
    const companion::Standing standing = companion::StandingOf(std::move(captured));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
    advised.advice_ms = std::max(advised.advice_ms, took.count());
    advised.sigma_so_far_m.push_back(LargestSigma_m(standing.advice));
    if (!standing.advice.next) {
      if (standing.so_far.unplaced.empty()) break;
      HoldSomewhere(held);
      continue;
    }
    const placement::NextPlacement& next = *standing.advice.next;
    held.Hold(standing.so_far.rig.cameras[next.camera].id, ByHand(held.Board(), next.T_camera_board, random));
  }
  advised.told = EndOf(held);
  return advised;
}

Told TiltAtRandom(HeldBoard& held, std::uint64_t seed) {
  sim::Random random(sim::KeyOf(seed, "random hand"));
  const auto& sensors = held.Experiment().rig.sensors;
  const double diagonal_m = PatternSize_m(held.Board()).norm();
  while (held.Captures() < kCapturesMax) {
    const auto camera = static_cast<std::size_t>(random.Uniform() * static_cast<double>(sensors.size()));
    placement::Stand stand;
    stand.right_rad = random.Uniform(-0.6, 0.6);
    stand.up_rad = random.Uniform(-0.45, 0.45);
    stand.distance_m = diagonal_m * random.Uniform(1.2, 4.0);
    const double tilt_rad = random.Uniform(0, 0.79), towards_rad = random.Uniform(0, 2 * M_PI);
    stand.tilt_right_rad = tilt_rad * std::cos(towards_rad);
    stand.tilt_up_rad = tilt_rad * std::sin(towards_rad);
    const Se3 T_camera_board = placement::PoseOf(stand, held.Board());
    if (held.SeenBy(sensors[camera].id, T_camera_board) > 1) held.Hold(sensors[camera].id, T_camera_board);
  }
  return EndOf(held);
}

struct Both {
  Advised advised;
  Told random;
};

Result<Both> RunSeed(const RigCase& one, std::uint64_t seed) {
  const std::string yaml = RingYaml(one.cameras, one.turn_deg, one.apart_m);
  RIGCAL_ASSIGN(HeldBoard advised, HeldBoard::Prepare(yaml, seed, one.lenses_given, kCapturesMax));
  RIGCAL_ASSIGN(HeldBoard random, HeldBoard::Prepare(yaml, seed, one.lenses_given, kCapturesMax));
  return Both{FollowAdvice(advised, seed), TiltAtRandom(random, seed)};
}

struct Sums {
  std::size_t advised = 0, random = 0, advised_paired = 0, random_paired = 0;
  std::int64_t advised_unended = 0, random_unended = 0, errors = 0, errors_within = 0;
  double advice_ms = 0.0;
  std::vector<double> told_over_so_far;

  void Add(const Both& both) {
    advised += both.advised.told.captures, random += both.random.captures;
    advised_paired += both.advised.told.paired, random_paired += both.random.paired;
    advised_unended += both.advised.told.has_ended ? 0 : 1, random_unended += both.random.has_ended ? 0 : 1;
    errors += both.advised.told.errors, errors_within += both.advised.told.errors_within;
    advice_ms = std::max(advice_ms, both.advised.advice_ms);
    if (const double ratio = both.advised.ToldOverSoFar(); ratio > 0) told_over_so_far.push_back(ratio);
  }
  void Write(formats::JsonWriter& out) {
    const auto middle = told_over_so_far.begin() + static_cast<std::ptrdiff_t>(told_over_so_far.size() / 2);
    std::nth_element(told_over_so_far.begin(), middle, told_over_so_far.end());
    out.Integer("advised", static_cast<std::int64_t>(advised));
    out.Integer("random", static_cast<std::int64_t>(random));
    out.Number("captures_ratio", static_cast<double>(advised) / static_cast<double>(random));
    out.Integer("advised_paired", static_cast<std::int64_t>(advised_paired));
    out.Integer("random_paired", static_cast<std::int64_t>(random_paired));
    out.Integer("advised_unended", advised_unended);
    out.Integer("random_unended", random_unended);
    out.Number("within_3_sigma_ratio",
               static_cast<double>(errors_within) / static_cast<double>(std::max<std::int64_t>(errors, 1)));
    out.Number("told_over_expected", middle == told_over_so_far.end() ? 0.0 : *middle);
    out.Number("advice_ms", advice_ms);
  }
};

// Half of the seeds before each rig.
Result<Sums> RunSeeds(std::size_t seeds) {
  std::vector<Result<Both>> outcomes(seeds, Fail(ErrorCode::kInternal, "not run", ""));
  ParallelFor(seeds, [&](std::size_t i) { outcomes[i] = RunSeed(kCases[i % std::size(kCases)], i + 1); });
  Sums sums;
  for (const Result<Both>& outcome : outcomes) {
    if (!outcome) return Fail(outcome.error());
    sums.Add(*outcome);
  }
  return sums;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 0;
  if (seeds < 1) {
    std::cerr << "usage: companion_measure SEEDS\n";
    return 2;
  }
  auto sums = rigcal::RunSeeds(static_cast<std::size_t>(seeds));
  if (!sums) {
    std::cerr << rigcal::Sentence(sums.error()) << '\n';
    return 2;
  }
  std::cout << rigcal::formats::WriteObject([&](rigcal::formats::JsonWriter& out) { sums->Write(out); }) << std::endl;
  return 0;
}

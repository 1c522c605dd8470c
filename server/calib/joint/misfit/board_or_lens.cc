#include "server/calib/joint/misfit/board_or_lens.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "server/calib/joint/misfit/instrument_effects.h"
#include "server/calib/joint/problem/board_bend.h"

namespace rigcal::calib::joint {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;

Matrix3d Block(const BendsSeen& bends, std::size_t i, std::size_t k) {
  return bends.C_m2.block<3, 3>(static_cast<Index>(3 * i), static_cast<Index>(3 * k));
}

bool IsSurelyBent(const BendsSeen& bends, std::size_t i) {
  const Eigen::Vector3d& b_m = bends.looks[i].b_m;
  return b_m.dot(Block(bends, i, i).ldlt().solve(b_m)) >= kSureBend;
}

// Of b_i against `ratio` times b_k, in squared sigmas.
double ApartInSquares(const BendsSeen& bends, std::size_t i, std::size_t k, double ratio) {
  const Eigen::Vector3d apart_m = bends.looks[i].b_m - ratio * bends.looks[k].b_m;
  const Matrix3d C_m2 =
      Block(bends, i, i) + ratio * ratio * Block(bends, k, k) - ratio * (Block(bends, i, k) + Block(bends, k, i));
  return apart_m.dot(C_m2.ldlt().solve(apart_m));
}

bool TwoLensesAgree(const BendsSeen& bends, std::size_t i, std::size_t k) {
  const BendSeen &one = bends.looks[i], &other = bends.looks[k];
  return one.target == other.target && one.camera != other.camera &&
         bends.lens_known[static_cast<std::size_t>(one.camera)] &&
         bends.lens_known[static_cast<std::size_t>(other.camera)] && IsSurelyBent(bends, k) &&
         ApartInSquares(bends, i, k, 1.0) < kSureBend;
}

// As strongly curved, a plate is the deeper the larger it is.
bool OtherBoardIsFlat(const BendsSeen& bends, std::size_t i, std::size_t k) {
  const BendSeen &one = bends.looks[i], &other = bends.looks[k];
  if (one.target == other.target || one.camera != other.camera || IsSurelyBent(bends, k)) return false;
  const double ratio = std::pow(bends.half_diagonal_m[static_cast<std::size_t>(one.target)] /
                                    bends.half_diagonal_m[static_cast<std::size_t>(other.target)],
                                2);
  return ApartInSquares(bends, i, k, ratio) >= kToldBend;
}

// Every board is as many boards as cameras see it, each bent as it likes; scales and prints stay as they are.
struct EachByItself {
  SessionProblem problem;
  SessionState state;
  std::vector<BendSeen> looks;
  std::vector<std::size_t> targets;  // of the looks, in `problem`
};

std::size_t AddTargetLike(std::size_t target, EachByItself& apart) {
  SessionProblem& problem = apart.problem;
  problem.targets.push_back(Target(problem.targets[target]));
  problem.target_points.push_back(std::vector<Eigen::Vector3d>(problem.target_points[target]));
  problem.target_bend_shapes.push_back(std::vector<Eigen::Vector3d>(problem.target_bend_shapes[target]));
  problem.bend_sigma_m.push_back(kAnyBend_m);
  problem.strain_sigma_ratio.push_back(0.0);
  apart.state.board_scale_ratio.push_back(double{apart.state.board_scale_ratio[target]});
  apart.state.board_bend_m.push_back(Eigen::Vector3d(apart.state.board_bend_m[target]));
  apart.state.print_strain_ratio.push_back(Eigen::Vector3d(apart.state.print_strain_ratio[target]));
  return problem.targets.size() - 1;
}

EachByItself TakenApart(const Explained& last) {
  EachByItself apart{last.start.problem, last.refined.state, {}, {}};
  for (Target& target : apart.problem.targets) target.square_sigma_m = 0.0;
  std::fill(apart.problem.bend_sigma_m.begin(), apart.problem.bend_sigma_m.end(), 0.0);
  std::fill(apart.problem.strain_sigma_ratio.begin(), apart.problem.strain_sigma_ratio.end(), 0.0);
  std::map<std::pair<int, int>, std::size_t> own;
  for (CornersSeen& seen : apart.problem.corners) {
    const auto [known, is_new] = own.try_emplace({seen.target, seen.camera}, 0);
    if (is_new) {
      known->second = AddTargetLike(static_cast<std::size_t>(seen.target), apart);
      apart.looks.push_back({seen.target, seen.camera, {}});
      apart.targets.push_back(known->second);
    }
    seen.target = static_cast<int>(known->second);
  }
  return apart;
}

// A lens that changed is several, of which none is what was given.
bool IsOneOfSeveral(const SessionProblem& problem, int camera) {
  std::set<int> lenses;
  std::set<SensorId> sensors;
  for (const CornersSeen& seen : problem.corners)
    if (seen.camera == camera) sensors.insert(problem.sensors[static_cast<std::size_t>(seen.sensor)]);
  for (const CornersSeen& seen : problem.corners)
    if (sensors.contains(problem.sensors[static_cast<std::size_t>(seen.sensor)])) lenses.insert(seen.camera);
  return lenses.size() > 1;
}

// Given, or with a sigma in each number that is refined; without a misfit or a change.
std::vector<bool> LensesKnown(const Explained& last) {
  const SessionProblem& problem = last.start.problem;
  std::vector<bool> known;
  for (std::size_t camera = 0; camera < problem.cameras.size(); ++camera) {
    const Lens& lens = problem.cameras[camera];
    const bool is_given =
        std::all_of(lens.refined.begin(), lens.refined.end(), [&](int i) { return lens.sigma[i] > 0; });
    known.push_back(is_given && !lens.is_freed && !IsOneOfSeveral(problem, static_cast<int>(camera)) &&
                    last.misfits.components.evidence[camera] < kMisfitEvidence);
  }
  return known;
}

std::optional<BendsSeen> SeenByEach(const Explained& last) {
  EachByItself apart = TakenApart(last);
  const auto refined = Refine(apart.problem, apart.state, last.refined.noise, last.refined.groups);
  if (!refined) return std::nullopt;
  const Eigen::MatrixXd C = refined->covariance + CovarianceByFields(FindMisfits(apart.problem, *refined));
  BendsSeen bends{std::move(apart.looks), {}, LensesKnown(last), {}};
  std::vector<int> rows;
  for (std::size_t i = 0; i < bends.looks.size(); ++i) {
    bends.looks[i].b_m = refined->state.board_bend_m[apart.targets[i]];
    for (int axis = 0; axis < 3; ++axis) rows.push_back(refined->layout.bend[apart.targets[i]] + axis);
  }
  bends.C_m2 = C(rows, rows);
  for (const Target& target : last.start.problem.targets)
    bends.half_diagonal_m.push_back(PlateSize_m(target).norm() / 2);
  return bends;
}

// By name.
std::vector<SensorId> CamerasThatSaw(const TargetId& board, const SessionProblem& problem) {
  std::set<SensorId> cameras;
  for (const CornersSeen& seen : problem.corners)
    if (problem.targets[static_cast<std::size_t>(seen.target)].id == board)
      cameras.insert(problem.sensors[static_cast<std::size_t>(seen.sensor)]);
  return {cameras.begin(), cameras.end()};
}

}  // namespace

bool IsTheBoard(const BendsSeen& bends, int target) {
  for (std::size_t i = 0; i < bends.looks.size(); ++i) {
    if (bends.looks[i].target != target || !IsSurelyBent(bends, i)) continue;
    for (std::size_t k = 0; k < bends.looks.size(); ++k)
      if (TwoLensesAgree(bends, i, k) || OtherBoardIsFlat(bends, i, k)) return true;
  }
  return false;
}

void AttributeBends(const Explained& last, std::vector<BoardBend>& bends) {
  if (bends.empty()) return;
  const SessionProblem& problem = last.start.problem;
  const auto seen = SeenByEach(last);
  for (BoardBend& bend : bends) {
    bend.seen_by = CamerasThatSaw(bend.board, problem);
    for (std::size_t t = 0; t < problem.targets.size() && seen; ++t)
      if (problem.targets[t].id == bend.board) bend.is_the_board |= IsTheBoard(*seen, static_cast<int>(t));
  }
}

}  // namespace rigcal::calib::joint

#include "server/calib/joint/misfit/given_lens.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/calib/joint/refine/cluster_covariance.h"
#include "server/math/covariance.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kContradicts = 70.0;  // squared sigmas of up to 14 numbers: odds of 2e-9
constexpr double kToldNothing = 1e-3;  // of the given variance: what the session adds less to is not judged
// As good as not given: part of the focal length, of the picture's width, of a distortion coefficient and at least.
constexpr double kFreeFocal_ratio = 0.05, kFreeCentre_ratio = 0.02, kFreeDistortion_ratio = 0.5,
                 kFreeDistortionMin = 1e-3;
constexpr int kFocals = 2, kPinholeNumbers = 4;
constexpr double kAlike_ratio = 0.25;  // another's intrinsics that fit four times better are its own

bool StillGiven(const Lens& lens) { return lens.is_given && !lens.is_freed; }
bool HasSigma(const Lens& lens) { return StillGiven(lens) && !lens.is_exact && lens.sigma[lens.refined.front()] > 0; }

Lens Freed(const Lens& lens) {
  const IntrinsicsVector& given = lens.given;
  Lens freed = lens;
  freed.refined.clear();
  freed.is_freed = true;
  for (int i = 0; i < IntrinsicsCount(lens.model); ++i) {
    if (i >= kPinholeNumbers && given[i] == 0.0) continue;  // a model with fewer coefficients
    freed.refined.push_back(i);
    freed.sigma[i] = i < kFocals           ? kFreeFocal_ratio * given[i]
                     : i < kPinholeNumbers ? kFreeCentre_ratio * lens.picture.width_px
                                           : std::max(kFreeDistortionMin, kFreeDistortion_ratio * std::abs(given[i]));
  }
  return freed;
}

Eigen::VectorXd Numbers(const Lens& lens, const IntrinsicsVector& values) {
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(lens.refined.size()));
  for (Eigen::Index i = 0; i < numbers.size(); ++i) numbers[i] = values[lens.refined[static_cast<std::size_t>(i)]];
  return numbers;
}

// d^T (S - C)^-1 d, without directions in which the session says next to nothing.
double SquaredSigmasOfPull(const Lens& lens, const IntrinsicsVector& refined, const Eigen::MatrixXd& C) {
  const Eigen::VectorXd sigma = Numbers(lens, lens.sigma);
  const Eigen::VectorXd d = (Numbers(lens, refined) - Numbers(lens, lens.given)).cwiseQuotient(sigma);
  const Eigen::MatrixXd M = sigma.cwiseInverse().asDiagonal() * C * sigma.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(M);
  double squares = 0.0;
  for (Eigen::Index i = 0; i < d.size(); ++i)
    if (const double told = 1 - axes.eigenvalues()[i]; told > kToldNothing)
      squares += std::pow(axes.eigenvectors().col(i).dot(d), 2) / told;
  return squares;
}

Eigen::MatrixXd BlockOf(const Lens& lens, int at, const Eigen::MatrixXd& C) {
  const auto count = static_cast<Eigen::Index>(lens.refined.size());
  return C.block(at, at, count, count);
}

std::vector<std::size_t> ContradictedWithSigma(const SessionProblem& problem, const Refined& refined, double limit) {
  std::vector<std::size_t> cameras;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Lens& lens = problem.cameras[c];
    if (HasSigma(lens) && SquaredSigmasOfPull(lens, refined.state.intrinsics[c],
                                              BlockOf(lens, refined.layout.lens[c], refined.covariance)) >= limit)
      cameras.push_back(c);
  }
  return cameras;
}

// By one step with all of them free.
std::vector<std::size_t> ContradictedExact(SessionProblem problem, const Refined& refined, double limit) {
  std::vector<std::size_t> exact, cameras;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c)
    if (StillGiven(problem.cameras[c]) && problem.cameras[c].is_exact) exact.push_back(c);
  if (exact.empty()) return cameras;
  for (const std::size_t c : exact) problem.cameras[c] = Freed(problem.cameras[c]);
  const auto one = StepFrom(problem, refined);
  if (!one) return cameras;
  for (const std::size_t c : exact) {
    const Lens& lens = problem.cameras[c];
    const int at = one->layout.lens[c];
    const Eigen::VectorXd d = Numbers(lens, refined.state.intrinsics[c]) - Numbers(lens, lens.given) +
                              one->step.segment(at, static_cast<Eigen::Index>(lens.refined.size()));
    const auto information = InverseOfDefinite(BlockOf(lens, at, one->covariance));
    if (information && d.dot(*information * d) >= limit) cameras.push_back(c);
  }
  return cameras;
}

// Rms over its corners, px, between what two sets of intrinsics make of them; nothing where one cannot see them.
std::optional<double> ShiftBetween(const Explained& one, std::size_t camera, const IntrinsicsVector& x,
                                   const IntrinsicsVector& y) {
  const SessionProblem& problem = one.start.problem;
  const CameraModel model = problem.cameras[camera].model;
  double squares_px2 = 0.0, count = 0.0;
  for (const CornersSeen& seen : problem.corners) {
    if (seen.camera != static_cast<int>(camera)) continue;
    const Se3 T_cam_board = T_sensor_board(one.refined.state, seen);
    for (const int idx : seen.corners.idx) {
      const Eigen::Vector3d p =
          T_cam_board * problem.target_points[static_cast<std::size_t>(seen.target)][static_cast<std::size_t>(idx)];
      const Projection by_x = Project(model, x, p), by_y = Project(model, y, p);
      if (!by_x.in_front || !by_y.in_front) return std::nullopt;
      squares_px2 += (by_x.uv_px - by_y.uv_px).squaredNorm(), count += 1;
    }
  }
  return count > 0 ? std::optional(std::sqrt(squares_px2 / count)) : std::nullopt;
}

SensorId NameOfCamera(const SessionProblem& problem, std::size_t camera) {
  for (const CornersSeen& seen : problem.corners)
    if (seen.camera == static_cast<int>(camera)) return problem.sensors[static_cast<std::size_t>(seen.sensor)];
  return {};
}

// Another camera whose given intrinsics fit this one.
SensorId GivenLikeIt(const Explained& before, const Explained& freed, std::size_t camera, double own_px) {
  const SessionProblem& problem = before.start.problem;
  const Lens& lens = problem.cameras[camera];
  const SensorId own = NameOfCamera(problem, camera);
  SensorId like;
  double least_px = kAlike_ratio * own_px;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Lens& other = problem.cameras[c];
    if (NameOfCamera(problem, c) == own || !other.is_given || other.model != lens.model ||
        other.picture.width_px != lens.picture.width_px)
      continue;
    const auto shift_px = ShiftBetween(freed, camera, other.given, freed.refined.state.intrinsics[camera]);
    if (shift_px && *shift_px < least_px) least_px = *shift_px, like = NameOfCamera(problem, c);
  }
  return like;
}

}  // namespace

std::vector<std::size_t> ContradictedLenses(const SessionProblem& problem, const Refined& refined) {
  const auto contradicted = [&](double limit) {
    std::vector<std::size_t> cameras = ContradictedWithSigma(problem, refined, limit);
    const std::vector<std::size_t> exact = ContradictedExact(problem, refined, limit);
    cameras.insert(cameras.end(), exact.begin(), exact.end());
    std::sort(cameras.begin(), cameras.end());
    return cameras;
  };
  if (contradicted(kContradicts).empty()) return {};
  return contradicted(kContradicts * std::max(1.0, CovarianceOfPoses(refined, {}).spread_ratio));
}

SessionStart WithLensesFree(SessionStart start, const Refined& refined, const std::vector<std::size_t>& cameras) {
  start.state = refined.state;
  start.noise = refined.noise;
  for (const std::size_t c : cameras) {
    start.problem.cameras[c] = Freed(start.problem.cameras[c]);
  }
  return start;
}

double LensPull(const SessionProblem& problem, const SessionState& state) {
  double squares = 0.0;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Lens& lens = problem.cameras[c];
    if (!HasSigma(lens)) continue;
    squares += (Numbers(lens, state.intrinsics[c]) - Numbers(lens, lens.given))
                   .cwiseQuotient(Numbers(lens, lens.sigma))
                   .squaredNorm();
  }
  return squares;
}

std::vector<ContradictedLens> ContradictedLensesTold(const Explained& before, const Explained& freed,
                                                     const std::vector<std::size_t>& cameras) {
  std::vector<ContradictedLens> told;
  for (const std::size_t c : cameras) {
    const IntrinsicsVector &given = before.start.problem.cameras[c].given, &refined = freed.refined.state.intrinsics[c];
    ContradictedLens lens{NameOfCamera(before.start.problem, c)};
    // Where the given ones show no corner at all there, they are off by any number of pixels.
    lens.shift_px = ShiftBetween(freed, c, given, refined).value_or(before.start.problem.cameras[c].picture.width_px);
    lens.shift_rad = lens.shift_px / refined.head<kFocals>().mean();
    lens.like = GivenLikeIt(before, freed, c, lens.shift_px);
    told.push_back(std::move(lens));
  }
  return told;
}

std::vector<ContradictedLens> StillContradicted(const std::vector<ContradictedLens>& told, const SessionProblem& given,
                                                const Explained& last) {
  const SessionProblem& problem = last.start.problem;
  const auto contradicts = [&](std::size_t c) {
    const Lens& freed = problem.cameras[c];
    const Eigen::VectorXd d = Numbers(freed, last.refined.state.intrinsics[c]) - Numbers(freed, freed.given);
    Eigen::MatrixXd C = BlockOf(freed, last.refined.layout.lens[c], last.refined.covariance);
    C.diagonal() += Numbers(freed, given.cameras[c].sigma).cwiseAbs2();
    const auto information = InverseOfDefinite(C);
    return !information || d.dot(*information * d) >= kContradicts;
  };
  std::vector<ContradictedLens> still;
  for (const ContradictedLens& lens : told)
    for (std::size_t c = 0; c < given.cameras.size(); ++c)
      if (NameOfCamera(given, c) == lens.camera && contradicts(c)) still.push_back(lens);
  return still;
}

}  // namespace rigcal::calib::joint

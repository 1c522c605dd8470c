// The bound against what an estimator reaches: maximum likelihood by Gauss-Newton with numerical derivatives of a
// forward model of the test's own, on the noisy observations of many seeds.
#include "client/sim/bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/sim/rig/lens.h"
#include "client/sim/rig/random.h"
#include "client/sim/visit/observe.h"
#include "server/math/statistics.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Poses, in order: of camera "side", lidar "top" and body in the reference; both boards in the world; the reference in
// the world at each capture.
using Poses = std::vector<Se3>;

class Problem {
 public:
  explicit Problem(const Experiment& experiment) : experiment_(experiment), seen_(Observe(experiment)) {
    for (const char* id : {"side", "top", "body"}) truth_.push_back(experiment.T_ref_sensor(SensorId(id)));
    for (const RigBoard& board : experiment.rig.boards) truth_.push_back(board.T_world_board());
    for (std::size_t k = 0; k < experiment.captures.size(); ++k)
      truth_.push_back(experiment.T_world_sensor(SensorId("left"), k));
  }

  [[nodiscard]] const Poses& truth() const { return truth_; }

  // Everything measured less what it should be, over its noise.
  [[nodiscard]] VectorXd Residuals(const Poses& poses) const {
    std::vector<double> r;
    for (std::size_t k = 0; k < experiment_.captures.size(); ++k) {
      const Se3& T_world_ref = poses[5 + k];
      AddView("left", T_world_ref, poses[3], k, r);
      AddView("side", T_world_ref * poses[0], poses[4], k, r);
      AddCloud("front", T_world_ref * poses[1], poses[3], k, r);
      AddCloud("side", T_world_ref * poses[1], poses[4], k, r);
      const Vector6d error =
          (seen_.tracker.at(SensorId("body"))[k].T_world_body.Inverse() * T_world_ref * poses[2]).Log();
      const TrackerTruth& tracker = experiment_.rig.SensorOf(SensorId("body")).tracker;
      for (int i = 0; i < 6; ++i) r.push_back(error[i] / (i < 3 ? tracker.sigma_m : tracker.sigma_rad));
    }
    return Eigen::Map<VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
  }

 private:
  void AddView(const char* id, const Se3& T_world_cam, const Se3& T_world_board, std::size_t k,
               std::vector<double>& r) const {
    const RigSensor& camera = experiment_.rig.SensorOf(SensorId(id));
    const BoardView& view = seen_.views.at(camera.id).at(experiment_.captures[k]);
    if (!view.found) return;
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& p : TargetPoints(experiment_.rig.BoardOf(*camera.sees).target))
      points.push_back(T_world_cam.Inverse() * (T_world_board * p));
    const auto pixels = PixelsOf(camera.camera.intrinsics, points);
    for (std::size_t i = 0; i < pixels.size(); ++i)
      for (const int axis : {0, 1})
        r.push_back((view.corners_px[i][axis] - pixels[i][axis]) / camera.camera.corner_sigma_px);
  }

  // The weight is that of the true incidence.
  void AddCloud(const char* board, const Se3& T_world_lidar, const Se3& T_world_board, std::size_t k,
                std::vector<double>& r) const {
    const RigSensor& lidar = experiment_.rig.SensorOf(SensorId("top"));
    const CloudView& view = seen_.clouds.at(lidar.id).at(experiment_.captures[k]).at(TargetId(board));
    if (!view.found) return;
    const Se3 T_true =
        experiment_.rig.BoardOf(TargetId(board)).T_world_board().Inverse() * experiment_.T_world_sensor(lidar.id, k);
    const Se3 T_board_lidar = T_world_board.Inverse() * T_world_lidar;
    for (const Eigen::Vector3f& point : view.candidates[0].points_m) {
      const Eigen::Vector3d p = point.cast<double>();
      const double cosine = std::abs((T_true.R() * p.normalized()).z());
      r.push_back((T_board_lidar * p).z() / (lidar.lidar.range_sigma_m * cosine));
    }
  }

  const Experiment& experiment_;
  Observations seen_;
  Poses truth_;
};

Poses Stepped(Poses poses, const VectorXd& step) {
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i] = poses[i] * Se3::Exp(step.segment<6>(6 * static_cast<Eigen::Index>(i)));
  return poses;
}

MatrixXd Jacobian(const Problem& problem, const Poses& at) {
  constexpr double kStep = 1e-5;
  const auto count = 6 * static_cast<Eigen::Index>(at.size());
  MatrixXd J(problem.Residuals(at).size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const VectorXd step = kStep * VectorXd::Unit(count, i);
    J.col(i) = (problem.Residuals(Stepped(at, step)) - problem.Residuals(Stepped(at, -step))) / (2 * kStep);
  }
  return J;
}

Poses MostLikely(const Problem& problem) {
  Poses poses = problem.truth();
  const MatrixXd J = Jacobian(problem, poses);
  const Eigen::LDLT<MatrixXd> H(J.transpose() * J);
  for (int i = 0; i < 4; ++i) poses = Stepped(poses, -H.solve(J.transpose() * problem.Residuals(poses)));
  return poses;
}

TEST(SimBound, IsWhatAMaximumLikelihoodEstimateReaches) {
  constexpr int kSeeds = 150;
  std::map<std::string, Vector6d> squares;
  const std::vector<std::string> names = {"side", "top", "body"};
  for (const std::string& name : names) squares[name] = Vector6d::Zero();
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.captures = 5;
    options.intrinsics = IntrinsicsKind::kExact;
    options.noise_factor = 0.3;  // so small that the problem is linear
    const Experiment experiment = Prepared(SmallRig(), options);
    const auto bound = CramerRaoBound(experiment);
    const Problem problem(experiment);
    const Poses poses = MostLikely(problem);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Vector6d error = (problem.truth()[i].Inverse() * poses[i]).Log();
      for (std::size_t axis = 0; axis < 6; ++axis)
        squares[names[i]][static_cast<int>(axis)] +=
            std::pow(error[static_cast<int>(axis)] / bound.at(SensorId(names[i])).at(axis).value(), 2);
    }
  }
  // 18 numbers at 1e-8 on each side.
  const double low = ChiSquareQuantile(1e-8, kSeeds), high = ChiSquareQuantile(1 - 1e-8, kSeeds);
  for (const std::string& name : names)
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_GT(squares[name][axis], low) << name << " " << tangent::kNames[static_cast<std::size_t>(axis)];
      EXPECT_LT(squares[name][axis], high) << name << " " << tangent::kNames[static_cast<std::size_t>(axis)];
    }
}

TEST(SimBound, IsTheDiagonalOfItsCovariance) {
  const Experiment experiment = Prepared(SmallRig());
  const auto bound = CramerRaoBound(experiment);
  for (const char* id : {"side", "top", "body"}) {
    const auto covariance = CramerRaoCovariance(experiment, SensorId(id));
    ASSERT_TRUE(covariance);
    for (int i = 0; i < 6; ++i)
      EXPECT_DOUBLE_EQ(std::sqrt((*covariance)(i, i)), bound.at(SensorId(id))[static_cast<std::size_t>(i)].value());
    EXPECT_TRUE(covariance->llt().info() == Eigen::Success);
  }
  Options options;
  options.motion = MotionKind::kPlanar;
  EXPECT_FALSE(CramerRaoCovariance(Prepared(SmallRig(), options), SensorId("body")));
}

// What a sensor moved by is known better than from either side by itself, as both sides know the others; and not at all
// where one side saw nothing.
TEST(SimBound, OfABumpIsAtMostWhatItsTwoSidesKnowByThemselves) {
  Options options;
  options.captures = 12;
  EXPECT_FALSE(CramerRaoCovarianceOfBump(Prepared(SmallRig(), options)));
  for (const char* id : {"side", "top", "left"}) {
    options.bump = SensorId(id);
    const Experiment whole = Prepared(SmallRig(), options);
    const auto bump = CramerRaoCovarianceOfBump(whole);
    ASSERT_TRUE(bump) << id;
    EXPECT_TRUE(bump->llt().info() == Eigen::Success) << id;
    if (std::string(id) == "left") continue;  // the reference's own pose is exact
    Matrix6d sides = Matrix6d::Zero();
    for (const bool after : {false, true}) {
      Experiment part = whole;
      const auto cut = static_cast<std::ptrdiff_t>(whole.bumped_from_idx);
      const auto keep = [&](auto& of_captures) {
        after ? of_captures.erase(of_captures.begin(), of_captures.begin() + cut)
              : of_captures.erase(of_captures.begin() + cut, of_captures.end());
      };
      keep(part.captures), keep(part.T_world_body), keep(part.stamps_ns);
      sides += CramerRaoCovariance(part, SensorId(id)).value();
    }
    EXPECT_GT((1.02 * sides - *bump).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0) << id;
    EXPECT_GT(bump->trace(), 0.02 * sides.trace()) << id;
  }
}

TEST(SimBound, LevelMotionLeavesTheTrackersHeightUnknownAndNothingElse) {
  Options options;
  options.captures = 12;
  options.motion = MotionKind::kPlanar;
  // The body's z axis is upright: along it nothing can be told.
  const auto bound = CramerRaoBound(Prepared(SmallRig(), options));
  const BoundSigma& body = bound.at(SensorId("body"));
  for (const std::size_t axis : {0, 1, 3, 4, 5}) EXPECT_TRUE(body[axis]) << axis;
  EXPECT_FALSE(body[2]);
}

TEST(SimBound, UnknownLensesKnowLessThanCalibratedThanExactOnes) {
  Options options;
  const auto sum = [&](IntrinsicsKind kind) {
    options.intrinsics = kind;
    const auto bound = CramerRaoBound(Prepared(SmallRig(), options));
    double total = 0;
    for (const std::optional<double>& sigma : bound.at(SensorId("side"))) total += sigma.value_or(1e9);
    return total;
  };
  const double exact = sum(IntrinsicsKind::kExact), calibrated = sum(IntrinsicsKind::kCalibrated);
  EXPECT_LT(exact, calibrated);
  EXPECT_LT(calibrated, sum(IntrinsicsKind::kAbsent));
}

TEST(SimBound, HalfTheNoiseHalvesItAndNoNoiseHasNone) {
  Options options;
  options.intrinsics = IntrinsicsKind::kExact;
  const auto whole = CramerRaoBound(Prepared(SmallRig(), options));
  options.noise_factor = 0.5;
  const auto half = CramerRaoBound(Prepared(SmallRig(), options));
  for (const auto& [id, sigma] : whole)
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(half.at(id)[i].value(), sigma[i].value() / 2, 0.01 * sigma[i].value());
  options.noise_factor = 0;
  EXPECT_TRUE(CramerRaoBound(Prepared(SmallRig(), options)).empty());
}

}  // namespace
}  // namespace rigcal::sim

// However many measurements of one pose are merged, what none of them sees stays open.
#include <gtest/gtest.h>

#include <random>

#include "server/graph/fusion/merged_edge.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

constexpr double kSigma_m = 0.002, kSigma_rad = 5e-4;
const Se3 kTrue = Se3::Exp((Vector6d() << 0.3, 0.5, -0.2, 0.1, 1.2, -0.4).finished());

// Of a robot on a flat floor: everything but the height along `up`, which lies as the measured rotation has it.
class PlanarVisits {
 public:
  Edge Measured(const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ()) {
    Edge edge;
    edge.robot = RobotId("r");
    edge.frame_a = SensorId("a"), edge.frame_b = SensorId("b");
    edge.state = EdgeState::kGood;
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = (k < 3 ? kSigma_m : kSigma_rad) * normal_(random_);
    edge.T_a_b = (kTrue * Se3::Exp(error)).Normalized();
    const Eigen::Vector3d open = edge.T_a_b.R().transpose() * up;
    edge.T_a_b.p_m += 0.3 * normal_(random_) * up;  // where the solver happened to leave it
    Matrix6d Omega = EachAxis(kSigma_m, kSigma_rad).cwiseAbs2().cwiseInverse().asDiagonal();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - open * open.transpose();
    Omega.topLeftCorner<3, 3>() = across * Omega.topLeftCorner<3, 3>() * across;
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    return edge;
  }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

Vector6d Along(const Edge& edge, const Eigen::Vector3d& axis) {
  return (Vector6d() << edge.T_a_b.R().transpose() * axis, Eigen::Vector3d::Zero()).finished();
}

TEST(JoinedInformation, LeavesOpenWhatNobodyMeasured) {
  PlanarVisits visits;
  MergedEdge merged;
  constexpr int kVisits = 600;
  for (int visit = 0; visit < kVisits; ++visit) {
    const Edge edge = visits.Measured();
    ASSERT_EQ(edge.uncertainty.rank, 5);
    Add(edge, {visit}, merged);
    ASSERT_EQ(EdgeOf(merged, edge.robot).uncertainty.rank, 5) << visit;
  }
  const Edge edge = EdgeOf(merged, RobotId("r"));
  EXPECT_GT(edge.uncertainty.unobservable_basis.col(0).normalized().dot(Along(edge, Eigen::Vector3d::UnitZ())),
            0.99999);
  // And the rest is known as well as by all of them.
  const Vector6d level = Along(edge, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(level.dot(edge.uncertainty.Omega * level) / (kVisits / (kSigma_m * kSigma_m)), 1.0, 0.01);
  const Eigen::Vector3d off = edge.T_a_b.p_m - kTrue.p_m;
  EXPECT_LT(off.head<2>().norm(), 5 * kSigma_m / std::sqrt(kVisits));
}

// A robot that was on a ramp besides: what each leaves open the other sees.
TEST(JoinedInformation, KnowsWhatTheOtherSees) {
  PlanarVisits visits;
  MergedEdge merged;
  Add(visits.Measured(), {1}, merged);
  Add(visits.Measured(Eigen::Vector3d(0.0, 0.2, 1.0).normalized()), {2}, merged);
  EXPECT_EQ(EdgeOf(merged, RobotId("r")).uncertainty.rank, 6);
}

}  // namespace
}  // namespace rigcal::graph

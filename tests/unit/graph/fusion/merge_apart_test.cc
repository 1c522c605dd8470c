// Older edges of a pair that scatter by more than they say, or contradict each other: merged all the same, and no sigma
// is too small.
#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

#include "server/graph/fusion/merged_edge.h"
#include "server/graph/fusion/scatter_of_most.h"
#include "server/graph/solve/solve.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "tests/unit/graph/fusion/drawn_pairs.h"

namespace rigcal::graph {
namespace {

constexpr double kPushedSigma = 1e-6;  // of an edge, as it says

// What a robot's revisions hold of one pair that is pushed week after week.
class OnePair {
 public:
  explicit OnePair(unsigned seed) : random_(seed) {}

  // Scatters by so many sigmas along each axis; is `moved` from where it was at first, in sigmas; does not see `open`.
  void Week(const Vector6d& scatter, const Vector6d& moved = Vector6d::Zero(), int open = -1) {
    Edge edge;
    edge.robot = kRobot;
    edge.frame_a = SensorId("a"), edge.frame_b = SensorId("b");
    edge.method = "stereo";
    edge.state = EdgeState::kGood;
    edge.T_a_b = T_true_ * Se3::Exp(kPushedSigma * moved) *
                 Se3::Exp(kPushedSigma * (Normals() + scatter.cwiseProduct(Normals()).eval()).eval());
    Matrix6d Omega = Matrix6d::Identity() / (kPushedSigma * kPushedSigma);
    if (open >= 0) Omega(open, open) = 0;
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    edge.id = PushedEdgeId(kRobot, ContentDigest(edge), 0);
    measured_at_[edge.id] = Stamp{1'000'000'000LL * ++weeks_};
    all_.push_back(edge);
    window_.push_back(std::move(edge));
    const Merge merge = MergeOlderEdges(merged_, window_, measured_at_);
    merged_ = merge.merged;
    const std::set<EdgeId> taken(merge.taken.begin(), merge.taken.end());
    std::erase_if(window_, [&](const Edge& one) { return taken.contains(one.id); });
  }
  void Weeks(int count, const Vector6d& scatter, const Vector6d& moved = Vector6d::Zero()) {
    for (int week = 0; week < count; ++week) Week(scatter, moved);
  }

  [[nodiscard]] const std::vector<Edge>& window() const { return window_; }
  [[nodiscard]] const std::vector<MergedEdge>& merged() const { return merged_; }
  [[nodiscard]] std::vector<Edge> Held() const {
    std::vector<Edge> held = window_;
    for (const MergedEdge& one : merged_) held.push_back(EdgeOf(one, kRobot));
    return held;
  }
  [[nodiscard]] int Counted() const {
    return std::accumulate(merged_.begin(), merged_.end(), static_cast<int>(window_.size()),
                           [](int sum, const MergedEdge& one) { return sum + one.count; });
  }
  // What the merged edge is off, in its own sigmas.
  [[nodiscard]] Vector6d Off() const {
    const Edge edge = EdgeOf(merged_.front(), kRobot);
    return (T_true_.Inverse() * edge.T_a_b).Log().cwiseQuotient(edge.uncertainty.covariance.diagonal().cwiseSqrt());
  }
  [[nodiscard]] SensorPose Whole() const { return PoseOf(all_); }
  [[nodiscard]] static SensorPose PoseOf(const std::vector<Edge>& edges) {
    return Solve(GraphOf(edges, SensorId("a"))).poses.back();
  }

 private:
  Vector6d Normals() {
    return Vector6d::NullaryExpr([&] { return std::normal_distribution<double>()(random_); });
  }

  std::mt19937 random_;
  Se3 T_true_ = Se3::Exp(Vector6d::LinSpaced(0.1, 0.6));
  int weeks_ = 0;
  std::vector<Edge> all_, window_;
  std::vector<MergedEdge> merged_;
  std::map<EdgeId, Stamp> measured_at_;
};

constexpr std::size_t kHeldMost = 2 * kEdgesKeptOfPair;

TEST(MergeApart, EdgesThatScatterAreMergedAndTheRevisionDoesNotGrow) {
  OnePair pair(3);
  for (int week = 0; week < 520; ++week) {
    pair.Week(Vector6d::Constant(3.0));
    ASSERT_LE(pair.window().size(), kHeldMost) << week;
  }
  EXPECT_EQ(pair.Counted(), 520);
  ASSERT_EQ(pair.merged().size(), 1u);
  EXPECT_GE(pair.merged().front().count, 500);
}

struct Scatters {
  Vector6d sigmas;
  double widest;  // variance of what is told over what is true
};
class MergedScatter : public testing::TestWithParam<Scatters> {};

// Squares of 60 robots along six axes, in what the merged edges say: of mean 1 where these are right, below where they
// are on the safe side.
TEST_P(MergedScatter, IsAsSureAsItIsRight) {
  constexpr int kRobots = 60;
  Vector6d squares = Vector6d::Zero();
  for (unsigned seed = 0; seed < kRobots; ++seed) {
    OnePair pair(100 + seed);
    pair.Weeks(80, GetParam().sigmas);
    squares += pair.Off().cwiseAbs2() / kRobots;
  }
  for (int axis = 0; axis < 6; ++axis)
    EXPECT_GT(ChiSquareTail(kRobots * squares[axis], kRobots), 1e-5) << axis << ": " << squares[axis];
  EXPECT_GT(squares.mean(), 1 / GetParam().widest) << squares.transpose();
}

Vector6d OneAxis(double sigmas) {
  Vector6d scatter = Vector6d::Zero();
  scatter[4] = sigmas;
  return scatter;
}

INSTANTIATE_TEST_SUITE_P(Kinds, MergedScatter,
                         testing::Values(Scatters{Vector6d::Zero(), 1.5}, Scatters{Vector6d::Constant(3.0), 3.0},
                                         Scatters{Vector6d::Constant(30.0), 3.0}, Scatters{OneAxis(5.0), 3.0},
                                         Scatters{OneAxis(50.0), 3.0}));

// What was measured before and after stays apart, each exactly as all of its edges say it together.
TEST(MergeApart, AnUnsaidMoveIsNoScatter) {
  OnePair pair(5);
  Vector6d moved = Vector6d::Zero();
  moved[0] = 50;
  pair.Weeks(30, Vector6d::Zero());
  for (int week = 0; week < 100; ++week) {
    pair.Week(Vector6d::Zero(), moved);
    ASSERT_LE(pair.window().size(), kHeldMost + 1) << week;
  }
  ASSERT_EQ(pair.merged().size(), 2u);
  EXPECT_EQ(pair.merged()[0].count, 30);
  EXPECT_EQ(pair.merged()[1].count, 100 - 8);
  EXPECT_EQ(pair.merged()[1].part, 1);
  EXPECT_FALSE(Agree(EdgeOf(pair.merged()[0], kRobot), EdgeOf(pair.merged()[1], kRobot)));
  const SensorPose whole = pair.Whole(), told = OnePair::PoseOf(pair.Held());
  EXPECT_LT((whole.T_ref_sensor.Inverse() * told.T_ref_sensor).Log().norm(), 1e-3 * kPushedSigma);
  EXPECT_LT((whole.covariance - told.covariance).norm(), 1e-3 * whole.covariance.norm());
}

TEST(MergeApart, OfManyMovesAndOfWildEdgesNoMoreAreHeld) {
  OnePair moves(7), wild(8), open(9);
  for (int week = 0; week < 300; ++week) {
    Vector6d moved = Vector6d::Constant(100.0 * (week / 30));
    moves.Week(Vector6d::Zero(), moved);
    wild.Week(Vector6d::Constant(week % 2 == 0 ? 0.0 : 1000.0));
    open.Week(Vector6d::Constant(20.0), Vector6d::Zero(), 2);
    for (const OnePair* pair : {&moves, &wild, &open}) {
      ASSERT_LE(pair->window().size(), kHeldMost) << week;
      ASSERT_LE(pair->merged().size(), kMergedPartsMax) << week;
      ASSERT_EQ(pair->Counted(), week + 1);
    }
  }
  EXPECT_EQ(moves.merged().size(), kMergedPartsMax);
  for (const MergedEdge& one : moves.merged())  // what is not of the part makes it no surer
    EXPECT_LT(one.Omega(0, 0) * kPushedSigma * kPushedSigma, 31.0);
}

TEST(ScatterOfMost, TellsScatterAndNoMovesNorWrongEdges) {
  std::mt19937 random(4);
  const auto places = [&](double scatter, const std::vector<double>& moved) {
    std::vector<MeasuredPlace> drawn;
    for (const double x : moved) {
      Vector6d e = Vector6d::NullaryExpr([&] { return std::normal_distribution<double>()(random); });
      e *= std::sqrt(1 + scatter * scatter);
      e[0] += x;
      drawn.push_back({Se3::Exp(1e-6 * e), 1e-12 * Matrix6d::Identity()});
    }
    return drawn;
  };
  const std::vector<double> still(8, 0.0), step{0, 0, 0, 0, 500, 500, 500, 500}, wrong{0, 900, 0, 0, 0, 0, 0, 0};
  int shown = 0;
  double found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    for (const auto& moved : {still, step, wrong}) shown += ScatterOfMost(places(0.0, moved)).isZero(0.0) ? 0 : 1;
    found += ScatterOfMost(places(10.0, still)).trace() / 6e-12 / 200;
  }
  EXPECT_LT(shown, 60);
  EXPECT_GT(found, 90.0);
  EXPECT_LT(found, 200.0);
  EXPECT_TRUE(ScatterOfMost(places(100.0, {0, 0, 0, 0})).isZero(0.0));
}

}  // namespace
}  // namespace rigcal::graph

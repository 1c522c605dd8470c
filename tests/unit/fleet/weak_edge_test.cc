// A weak measurement, and what it must not hide: that sure ones disagree. Graphs are solved, and their loops worked
// out, as those of robots are.
#include <gmock/gmock.h>

#include "server/fleet/assess.h"
#include "server/fleet/findings/verdict_keys.h"
#include "server/graph/insight/insight.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;

// Sensors one metre apart each, all looking alike.
class Robot {
 public:
  // `off`: what the measurement errs by; estimated from so many captures that its limits are those of known ones.
  Edge& Add(int a, int b, double sigma, const Vector6d& off = Vector6d::Zero()) {
    constexpr int kMany = 100'000;
    Edge edge;
    const std::string digits = std::to_string(1000 + edges_.size());
    edge.id = EdgeId(digits + std::string(64 - digits.size(), '0'));
    edge.frame_a = Name(a), edge.frame_b = Name(b);
    edge.T_a_b = PlaceOf(a).Inverse() * PlaceOf(b) * Se3::Exp(off);
    edge.uncertainty = FromInformation(Matrix6d::Identity() / (sigma * sigma), UncertaintySource::kGiven, kMany);
    edge.state = EdgeState::kGood;
    edges_.push_back(edge);
    return edges_.back();
  }
  // In both directions in turn, each a session's.
  void AddTwice(int a, int b, double sigma, const Vector6d& off = Vector6d::Zero()) {
    Add(a, b, sigma, off);
    Add(a, b, sigma, off);
  }
  // By its forward, left and up, those of s0.
  void KnowAxes() { R_ref_robot_ = Eigen::Matrix3d::Identity(); }
  void ForgetAxes() { R_ref_robot_.reset(); }
  [[nodiscard]] Judgement Judged(const Policy& policy = {}) const {
    const Graph graph = graph::GraphOf(edges_, Name(0));
    const GraphSolution solution = SolutionOf(graph);
    return fleet::Judge(edges_, solution, policy, {}, {}, {}, {{}, graph::OtherPathsOf(graph, solution)});
  }
  [[nodiscard]] Verdict Judge(const Policy& policy = {}) const { return Judged(policy).verdict; }
  [[nodiscard]] std::vector<std::string> Keys() const {
    const Graph graph = graph::GraphOf(edges_, Name(0));
    const GraphSolution solution = SolutionOf(graph);
    return KeysOfVerdict(Judge(), edges_, solution, {}, {}, {}, graph::OtherPathsOf(graph, solution));
  }

 private:
  [[nodiscard]] GraphSolution SolutionOf(const Graph& graph) const {
    GraphSolution solution = graph::Solve(graph);
    solution.R_ref_robot = R_ref_robot_;
    solution.influences = graph::InfluenceOfEdges(graph, solution);
    solution.cycles = graph::JudgeCycles(graph, {});
    return solution;
  }
  static SensorId Name(int k) { return SensorId("s" + std::to_string(k)); }
  static Se3 PlaceOf(int k) {
    Se3 T;
    T.p_m << k % 3, k / 3, 0.3 * (k % 2);
    return T;
  }
  std::vector<Edge> edges_;
  std::optional<Eigen::Matrix3d> R_ref_robot_;
};

Vector6d Shift(double x_m) { return x_m * Vector6d::Unit(tangent::kX); }

// Two millimetres each, open by eight: may be chance, and is more than five. Across it one that knows nothing.
Robot OpenSquare(double open_m, double weak_off_m) {
  constexpr double kSigma = 0.002, kWeak = 0.05;
  Robot robot;
  robot.Add(0, 1, kSigma);
  robot.Add(1, 2, kSigma, Shift(open_m));
  robot.Add(2, 3, kSigma);
  robot.Add(3, 0, kSigma);
  robot.Add(0, 2, kWeak, Shift(weak_off_m));
  return robot;
}

TEST(WeakEdge, DoesNotHideThatALoopOfSureOnesIsOpen) {
  const Verdict verdict = OpenSquare(0.008, 0.06).Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("differ by 8."));
  EXPECT_THAT(verdict.why, HasSubstr("s0 - s2 is known to 50 mm only"));
  EXPECT_THAT(verdict.why, Not(HasSubstr("not checked: s0 - s2"))) << "four sure ones check each other";
  EXPECT_THAT(verdict.what_to_do, HasSubstr("Capture s"));
  EXPECT_THAT(verdict.what_to_do, Not(HasSubstr("these sensors")));
}

TEST(WeakEdge, AloneIsToldAlone) {
  const Verdict verdict = OpenSquare(0.002, 0.06).Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "s0 - s2 is known to 50 mm only: too little to check it by.");
}

TEST(WeakEdge, IsToldForThoseThatItAloneChecks) {
  Robot robot = OpenSquare(0.0, 0.0);
  robot.Add(2, 4, 0.001);
  robot.Add(4, 0, 0.05, Shift(0.07));
  const Verdict verdict = robot.Judge();
  EXPECT_THAT(verdict.why, HasSubstr("s2 - s4 is not checked: s4 - s0 is known to 50 mm only"));
  EXPECT_THAT(verdict.why, Not(HasSubstr("differ by")));
}

// Nobody is "by far the weakest": both are named by what they are off, and the sure loop all the same.
TEST(WeakEdge, TwoAlikeHideNoneEither) {
  Robot robot = OpenSquare(0.008, 0.06);
  robot.Add(1, 3, 0.05, Shift(-0.06));
  const Verdict verdict = robot.Judge();
  EXPECT_THAT(verdict.why, HasSubstr("differ by 8."));
  EXPECT_THAT(verdict.why, HasSubstr("differ by 6"));
}

// Each pair twice, alike: no single edge is off by much, the loop is open by 12 mm.
Robot OpenRing(double open_m) {
  constexpr double kSigma = 0.002;
  Robot robot;
  robot.AddTwice(0, 1, kSigma);
  robot.AddTwice(1, 2, kSigma, Shift(open_m));
  robot.AddTwice(2, 3, kSigma);
  robot.AddTwice(3, 0, kSigma);
  return robot;
}

TEST(WeakEdge, DoesNotHideALoopNoneOfWhoseEdgesIsOffByMuch) {
  const Verdict ring = OpenRing(0.012).Judge();
  EXPECT_EQ(ring.level, VerdictLevel::kWarn);
  EXPECT_THAT(ring.why, HasSubstr("is open by 12 mm"));
  Robot robot = OpenRing(0.012);
  robot.Add(1, 3, 0.05, Shift(-0.06));
  const Verdict verdict = robot.Judge();
  EXPECT_THAT(verdict.why, HasSubstr("is open by 12 mm"));
  EXPECT_THAT(verdict.why, HasSubstr("s1 - s3 is known to 50 mm only"));
}

// More loops than are listed are nearer to their limits, none of them open by more than a millimetre.
TEST(WeakEdge, ManySureLoopsHideNoLargeOne) {
  constexpr double kSigma = 0.0002;
  Robot robot = OpenRing(0.012);
  for (int a = 4; a < 12; ++a)
    for (int b = a + 1; b < 12; ++b) robot.Add(a, b, kSigma, Shift((a + b) % 2 == 0 ? 0.00045 : -0.00045));
  robot.AddTwice(0, 4, kSigma);
  const Verdict verdict = robot.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn) << verdict.why;
  EXPECT_THAT(verdict.why, HasSubstr("is open by 12 mm"));
}

// Forty loops that close cost less than chance allows by more than one costs that does not.
TEST(WeakEdge, ManyLoopsThatCloseHideNoneThatDoesNot) {
  Robot robot;
  for (int a = 0; a < 9; ++a)
    for (int b = a + 1; b < 9; ++b) robot.Add(a, b, 0.0003).uncertainty.dof = 0;
  robot.Add(8, 9, 0.0003).uncertainty.dof = 0;
  robot.Add(9, 10, 0.0003).uncertainty.dof = 0;
  robot.Add(10, 8, 0.0003, Shift(0.0035)).uncertainty.dof = 0;
  EXPECT_EQ(robot.Judge().level, VerdictLevel::kFail) << robot.Judge().why;
}

// Two sure ones, closed by one that knows its place to half a metre and happens to agree.
TEST(WeakEdge, ThatAgreesIsNoCheckOfTheOthers) {
  const auto judge = [](double closing) {
    Robot robot;
    robot.Add(0, 1, 0.001);
    robot.Add(1, 2, 0.001);
    robot.Add(2, 0, closing);
    return robot.Judge();
  };
  EXPECT_EQ(judge(0.001).level, VerdictLevel::kPass) << judge(0.001).why;
  const Verdict verdict = judge(0.5);
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "s0 - s1 and s1 - s2 are not checked: s2 - s0 is known to 500 mm only.");
}

// Where several are as weak, none of them is named for it.
TEST(WeakEdge, HowFarSeveralOfThemCheckIsSaid) {
  Robot robot;
  robot.Add(0, 1, 0.001);
  robot.Add(1, 2, 0.01);
  robot.Add(0, 2, 0.01);
  robot.Add(1, 3, 0.001);
  robot.Add(3, 0, 0.001);
  robot.Add(0, 2, 0.001);
  const Verdict verdict = robot.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(
      verdict.why,
      HasSubstr("osition of s0 - s2 is not checked: the other measurements tell it to 7.1 mm only (limit 5 mm)"));
  EXPECT_THAT(verdict.why, Not(HasSubstr("s0 - s1")));
}

// What nothing but a turn checks is checked in its turn alone.
TEST(WeakEdge, OfWhatIsCheckedInPartTheRestIsNamed) {
  Robot robot;
  robot.Add(0, 1, 0.001);
  robot.Add(1, 2, 0.001);
  Edge& turn = robot.Add(2, 0, 0.001);
  Matrix6d Omega = turn.uncertainty.Omega;
  Omega.topLeftCorner<3, 3>().setZero();
  turn.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, turn.uncertainty.dof);
  const Verdict verdict = robot.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "The position of s0 - s1 and s1 - s2 is not checked by anything else.");
  EXPECT_EQ(verdict.what_to_do,
            "Repeat s0 - s1 and s1 - s2 in a session of their own, with motion or boards in every direction.");
  EXPECT_THAT(robot.Keys(), testing::ElementsAre("hardly_checked"));
  const std::vector<HardlyChecked> told = robot.Judged().basis.hardly_checked;
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].edge.str().substr(0, 4), "1000");
  EXPECT_EQ(told[0].what, "the position is not checked by anything else");
  EXPECT_EQ(told[1].edge.str().substr(0, 4), "1001");
}

// A camera and a lidar that see boards from one side: what a shift and a turn have in common, neither knows alone.
TEST(WeakEdge, WhatAnEdgeKnowsWithItsTurnAloneIsNotItsTolerance) {
  Robot robot;
  Matrix6d C = Matrix6d::Identity();
  C.topLeftCorner<3, 3>() *= 0.008 * 0.008;
  C.bottomRightCorner<3, 3>() *= 0.0025 * 0.0025;
  C(0, 4) = C(4, 0) = C(1, 3) = C(3, 1) = 0.95 * 0.008 * 0.0025;
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}, {0, 1}, {1, 2}, {2, 0}})
    robot.Add(a, b, 0.008).uncertainty = FromInformation(C.inverse(), UncertaintySource::kGiven, 100'000);
  EXPECT_THAT(robot.Judge().why, Not(HasSubstr("not checked"))) << "no edge tells its position to 5 mm";
}

// On a level floor wheels tell no height: that of two sensors has one measurement, all else has two.
Robot OnWheels() {
  Robot robot;
  robot.KnowAxes();
  robot.Add(0, 2, 0.001);
  for (const int side : {0, 2}) {
    Edge& wheels = robot.Add(side, 4, 0.001);
    Matrix6d Omega = wheels.uncertainty.Omega;
    Omega.row(tangent::kZ).setZero(), Omega.col(tangent::kZ).setZero();
    wheels.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, wheels.uncertainty.dof);
  }
  return robot;
}

Policy WithoutHeightOf(std::initializer_list<const char*> sensors, const char* height = "height") {
  Policy policy;
  for (const char* sensor : sensors) policy.sensors[SensorId(sensor)].not_needed = {height};
  return policy;
}

TEST(WeakEdge, OfAPositionTheAxisThatNothingChecksIsNamed) {
  EXPECT_EQ(OnWheels().Judge(WithoutHeightOf({"s4"})).level, VerdictLevel::kWarn);
  EXPECT_THAT(OnWheels().Judge(WithoutHeightOf({"s4"})).why,
              HasSubstr("eight of s0 - s2 is not checked by anything else."));
  EXPECT_THAT(OnWheels().Judge(WithoutHeightOf({"s4"})).why, Not(HasSubstr("osition of s0")));
}

TEST(WeakEdge, WithoutTheRobotsAxesItIsOneOfTheReference) {
  Robot robot = OnWheels();
  robot.ForgetAxes();
  EXPECT_THAT(robot.Judge(WithoutHeightOf({"s4"}, "z of s0")).why,
              HasSubstr("f s0 - s2 the position along z of s0 is not checked by anything else."));
}

TEST(WeakEdge, AnAxisThatThePolicyDoesNotNeedIsToBeCheckedByNothing) {
  const Verdict verdict = OnWheels().Judge(WithoutHeightOf({"s2", "s4"}));
  EXPECT_EQ(verdict.level, VerdictLevel::kPass) << verdict.why;
}

}  // namespace
}  // namespace rigcal::fleet

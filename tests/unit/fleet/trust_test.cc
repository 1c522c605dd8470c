// A "pass" must be earned: what nothing checks, or no test could have caught, is said by name.
#include <gmock/gmock.h>

#include "server/fleet/assess.h"
#include "server/fleet/findings/bridges.h"
#include "server/model/graph/unchecked.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct Chain {
  std::vector<Edge> edges;
  GraphSolution solution;

  Chain() {
    solution.converged = true;
    solution.dof = 6;
  }
  void AddSensor(const std::string& name) {
    SensorPose pose;
    pose.sensor = SensorId(name);
    pose.known = true;
    if (!solution.poses.empty()) pose.covariance = 1e-6 * Matrix6d::Identity();
    solution.poses.push_back(pose);
  }
  void AddEdge(const std::string& a, const std::string& b, int dof, double off_m) {
    Edge edge;
    edge.id = EdgeId(std::string(64, static_cast<char>('a' + edges.size())));
    edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
    edge.uncertainty = FromInformation(1e6 * Matrix6d::Identity(), UncertaintySource::kGiven, dof);
    edge.state = EdgeState::kGood;
    EdgeResidual residual;
    residual.edge = edge.id;
    residual.in_solution = true;
    residual.e(tangent::kX) = off_m;
    residual.weighted = residual.e.dot(edge.uncertainty.Omega * residual.e);
    solution.cost += residual.weighted;
    solution.residuals.push_back(residual);
    edges.push_back(edge);
  }
  [[nodiscard]] Verdict Judge() const { return Assess(edges, solution); }
};

// Left, right and top in a triangle whose edges all have covariances from dof + 1 captures.
Chain Triangle(int dof, double off_m) {
  Chain chain;
  for (const char* name : {"left", "right", "top"}) chain.AddSensor(name);
  chain.AddEdge("left", "right", dof, off_m);
  chain.AddEdge("right", "top", dof, off_m);
  chain.AddEdge("left", "top", dof, off_m);
  return chain;
}

TEST(Trust, FewCapturesNeverPassForTheyCannotBeTested) {
  for (int dof = 1; dof <= 12; ++dof) {
    const Verdict verdict = Triangle(dof, 0.0005).Judge();
    EXPECT_EQ(verdict.level, VerdictLevel::kWarn) << dof;
    EXPECT_THAT(verdict.why, HasSubstr("Too few captures")) << dof;
  }
  EXPECT_EQ(Triangle(39, 0.0005).Judge().level, VerdictLevel::kPass);
}

TEST(Trust, AGrossContradictionFailsWhateverTheCaptures) {
  for (int dof = 1; dof <= 40; ++dof) EXPECT_EQ(Triangle(dof, 0.1).Judge().level, VerdictLevel::kFail) << dof;
}

TEST(Trust, ALongLoopThatDoesNotCloseFails) {
  Chain ring;
  for (int k = 0; k < 21; ++k) ring.AddSensor("s" + std::to_string(k));
  // 80 mm of closure shared by 21 edges of 1 mm: each edge alone is within its own limit.
  for (int k = 0; k < 21; ++k) ring.AddEdge("s" + std::to_string(k), "s" + std::to_string((k + 1) % 21), 0, 0.08 / 21);
  const Verdict verdict = ring.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("do not close"));
}

TEST(Trust, EdgesOfOneSessionAreNotIndependentSoTheirCostIsNoVerdict) {
  Chain chain = Triangle(0, 0.0035);  // cost 37 for 6 degrees of freedom, each edge below its own limit
  EXPECT_EQ(chain.Judge().level, VerdictLevel::kFail);
  for (Edge& edge : chain.edges) edge.session = SessionId(std::string(64, '1'));
  EXPECT_EQ(chain.Judge().level, VerdictLevel::kPass);
}

// e^T C^-1 e with C from 40 captures is larger than chi-square allows, and the more so the more edges there are.
TEST(Trust, EstimatedInformationMakesTheCostNoChiSquare) {
  EXPECT_EQ(Triangle(0, 0.0035).Judge().level, VerdictLevel::kFail);
  EXPECT_EQ(Triangle(39, 0.0035).Judge().level, VerdictLevel::kPass);
}

CycleResidual Loop(double t_squared, double limit) {
  CycleResidual loop;
  for (const char* name : {"left", "right", "top"}) loop.sensors.emplace_back(name);
  loop.e << 0.006, 0.008, 0.0, 0.0, 0.0, 0.0349065850398866;
  loop.tested = true;
  loop.t_squared = t_squared, loop.limit = limit;
  return loop;
}

TEST(Trust, AnOpenLoopOfEstimatedEdgesIsNamedByItsOwnTest) {
  Chain chain = Triangle(39, 0.0005);
  chain.solution.cycles.judged = true;
  chain.solution.cycles.worst = {Loop(80.0, 40.0)};
  chain.solution.cycles.failing = 1;
  const Verdict verdict = chain.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "The loop of left, right and top does not close: 10 mm, 2 deg off, 2 times what chance allows.");
  EXPECT_THAT(verdict.what_to_do, Not(HasSubstr("--remounted")));
  for (const Edge& edge : chain.edges) chain.solution.cycles.worst.front().edges.push_back(edge.id);
  for (Edge& edge : chain.edges) edge.session = SessionId(std::string(64, '1'));
  EXPECT_THAT(chain.Judge().what_to_do, Not(HasSubstr("--remounted")));
  chain.edges.back().session = SessionId(std::string(64, '2'));
  EXPECT_THAT(chain.Judge().what_to_do, HasSubstr("`rigcal push FOLDER --remounted left` of the later one, or right"));
  chain.solution.cycles.worst = {Loop(39.0, 40.0)};
  chain.solution.cycles.failing = 0;
  EXPECT_EQ(chain.Judge().level, VerdictLevel::kWarn) << "10 mm and 2 deg, though it may be chance";
}

TEST(Trust, ASensorOnASingleEdgeIsUnchecked) {
  Chain chain = Triangle(39, 0.0005);
  chain.AddSensor("tail");
  chain.AddSensor("tip");
  chain.AddEdge("top", "tail", 39, 0.0);
  chain.AddEdge("tip", "tail", 39, 0.0);
  EXPECT_THAT(FindBridges(chain.edges, chain.solution).sensors, ElementsAre(SensorId("tail"), SensorId("tip")));
  const Verdict verdict = chain.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("tail and tip"));
}

// Whatever a bridge says, it fits: more captures would not make it testable.
TEST(Trust, ABridgeOfFewCapturesIsUncheckedNotUntestable) {
  Chain chain = Triangle(39, 0.0005);
  chain.AddSensor("tail");
  chain.AddEdge("top", "tail", 6, 0.0);
  for (const bool by_jackknife : {false, true}) {
    chain.solution.residuals.back().by_jackknife = by_jackknife;
    EXPECT_EQ(chain.Judge().why, "Nothing checks the pose of tail: a single edge is the only tie to the reference.");
  }
  EXPECT_EQ(FindBridges(chain.edges, chain.solution).edges, std::set<EdgeId>{chain.edges.back().id});
}

// Two edges tie the tail, but what one of them sees the other does not.
TEST(Trust, EdgesThatTheirLoopsDoNotCheckAreNamed) {
  Chain chain = Triangle(39, 0.0005);
  chain.AddSensor("tail");
  chain.AddEdge("top", "tail", 39, 0.0);
  chain.AddEdge("tail", "left", 39, 0.0);
  EXPECT_EQ(chain.Judge().level, VerdictLevel::kPass);
  chain.solution.influences.judged = true;
  for (std::size_t k = 0; k < 5; ++k)
    chain.solution.influences.edges.push_back({chain.edges[k].id, k < 3, 0.0, SensorId(), Vector6d::Zero()});
  const Verdict verdict = chain.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why,
            "Nothing checks top - tail and tail - left: the other edges of their loops fit whatever they say.");
}

TEST(Trust, EdgesWhoseErrorsAreAllSharedAreUnchecked) {
  Chain chain = Triangle(0, 0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    chain.edges[k].session = SessionId(std::string(64, '1'));
    chain.solution.residuals[k].by_jackknife = true;  // rank 0: no error would show
  }
  EXPECT_EQ(UncheckedEdges(chain.solution).size(), 3U);
  const Verdict verdict = chain.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("Nothing checks left - right, right - top and left - top"));
}

TEST(Trust, AHeldBackPictureIsToldFirstAndDecidesNothing) {
  Chain chain = Triangle(39, 0.0005);
  const SessionId newest(std::string(64, '2')), older(std::string(64, '1'));
  chain.solution.fused.sessions = {newest, older};
  SessionHeader header;
  for (const char* name : {"left", "right"}) header.sensors.emplace_back().id = SensorId(name);
  header.sensors.emplace_back().id = SensorId("top");
  header.sensors.back().kind = SensorKind::kLidar;
  const auto judge = [&] {
    return Assess(chain.edges, chain.solution, {}, {}, {}, {{newest, header}, {older, header}});
  };
  chain.solution.fused.held_back = {{older, SensorId("right"), CaptureId("03")},
                                    {newest, SensorId("top"), CaptureId("06")}};
  EXPECT_THAT(judge().why, Not(HasSubstr("left out"))) << "of an older session, and of a lidar, it is no news";
  for (int board = 0; board < 2; ++board)
    chain.solution.fused.held_back.push_back({newest, SensorId("left"), CaptureId("07")});
  const Verdict verdict = judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_EQ(verdict.why,
            "What left saw in capture 07 contradicts the rest and was left out. Every sensor is known well enough.");
  EXPECT_EQ(verdict.what_to_do,
            "Check that left and the others take their pictures at the same moment; calibrate again when it is due.");
}

TEST(Trust, OnlyWhatWasTestedIsClaimed) {
  Chain chain = Triangle(39, 0.0005);
  EXPECT_THAT(chain.Judge().why, HasSubstr("the edges agree with each other."));
  chain.solution.cycles.judged = true;
  chain.solution.cycles.examined = 1;
  EXPECT_EQ(chain.Judge().level, VerdictLevel::kPass);
  EXPECT_EQ(chain.Judge().why,
            "Every sensor is known well enough and each edge passes its own test against the others; no loop could be "
            "tested as a whole.");
  chain.solution.cycles.tested = 1;
  EXPECT_THAT(chain.Judge().why, HasSubstr("the edges agree with each other."));
  chain.solution.cycles = {false, "Loops were left out: too many.", 0, 0, 0, {}};
  EXPECT_THAT(chain.Judge().why, HasSubstr("loops as a whole were not worked out."));
  for (Edge& edge : chain.edges) edge.uncertainty.dof = 0;  // their cost is a test of all loops at once
  EXPECT_THAT(chain.Judge().why, HasSubstr("the edges agree with each other."));
}

TEST(Trust, APairThatIsMeasuredTwiceIsNoBridge) {
  Chain chain = Triangle(39, 0.0005);
  chain.AddSensor("tail");
  chain.AddEdge("top", "tail", 39, 0.0);
  chain.AddEdge("tail", "top", 39, 0.0);
  EXPECT_TRUE(FindBridges(chain.edges, chain.solution).sensors.empty());
}

TEST(Trust, ALoopBehindABridgeIsStillTiedByOneEdge) {
  Chain chain = Triangle(39, 0.0005);
  for (const char* name : {"x", "y", "z"}) chain.AddSensor(name);
  chain.AddEdge("top", "x", 39, 0.0);
  chain.AddEdge("x", "y", 39, 0.0);
  chain.AddEdge("y", "z", 39, 0.0);
  chain.AddEdge("z", "x", 39, 0.0);
  EXPECT_THAT(FindBridges(chain.edges, chain.solution).sensors,
              ElementsAre(SensorId("x"), SensorId("y"), SensorId("z")));
}

}  // namespace
}  // namespace rigcal::fleet

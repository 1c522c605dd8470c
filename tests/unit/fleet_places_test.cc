// Sensors that are not where the drawing has them, and poses that are known but for some directions.
#include <gmock/gmock.h>

#include "server/fleet/partial_poses.h"
#include "server/model/past.h"
#include "tests/unit/fleet_rig.h"
#include "tests/unit/fleet_visit.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr double kDegree = M_PI / 180;

Se3 At(const Eigen::Vector3d& p_m, double yaw_rad = 0.0) {
  Se3 T;
  T.p_m = p_m;
  T.q = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
  return T;
}

// A drawing, and where its sensors were found; the first is the reference.
struct Drawn {
  Visit visit = Visit(StereoBoard());
  GraphSolution solution = SolutionOf({}, {});

  void Add(const std::string& name, SensorKind kind, const Se3& drawn, const Se3& measured, double sigma_m = 0.001) {
    visit.AddSensor(name, kind);
    const bool reference = visit.header.sensors.size() == 1;
    if (!reference) {
      visit.header.sensors.back().T_ref_nominal = drawn;
      visit.AddGood(visit.header.reference.str(), name);
    }
    SensorPose pose = PoseOf(name, true, reference ? 0.0 : sigma_m * sigma_m);
    pose.T_ref_sensor = measured;
    solution.poses.push_back(pose);
  }
  [[nodiscard]] std::vector<RootCause> Causes() const { return visit.Causes(solution); }
  [[nodiscard]] Verdict Judge() const { return visit.Judge(solution); }
};

Drawn WithReference(SensorKind kind = SensorKind::kLidar) {
  Drawn drawn;
  drawn.Add("base", kind, {}, {});
  return drawn;
}

const Se3 kLeft = At({1, 0.211, 0.5}), kRight = At({1, -0.211, 0.5});

TEST(Exchanged, TwoCamerasAtEachOthersPlaces) {
  Drawn drawn = WithReference();
  drawn.Add("front_left", SensorKind::kCamera, kLeft, kRight);
  drawn.Add("front_right", SensorKind::kCamera, kRight, kLeft * At({0.004, 0, 0}));
  drawn.Add("rear", SensorKind::kCamera, At({-1, 0, 0.5}, M_PI), At({-1, 0.01, 0.5}, M_PI));
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kExchanged);
  EXPECT_THAT(causes[0].sensors, ElementsAre(SensorId("front_left"), SensorId("front_right")));
  const Verdict verdict = drawn.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "front_left and front_right look exchanged: each sits where the other should be (422 mm and 0 deg "
            "from nominal).");
  EXPECT_EQ(verdict.what_to_do, "Exchange their folders, or their names in session.yaml, then `rigcal push FOLDER`.");
}

TEST(Exchanged, TwoLidarsExplainWhyTheirCloudsDoNotMatch) {
  Drawn drawn = WithReference(SensorKind::kCamera);
  const Se3 up = At({0.2, 0, 1.5}), down = At({0.2, 0, 0.3}, 90 * kDegree);
  drawn.Add("lidar_up", SensorKind::kLidar, up, down);
  drawn.Add("lidar_down", SensorKind::kLidar, down, up);
  drawn.visit.AddFailed("lidar_up", "lidar_down", "lidar_lidar", "low_overlap");
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_THAT(causes[0].edges, SizeIs(1));
  EXPECT_THAT(causes[0].said.why, HasSubstr("(1200 mm and 90 deg from nominal)"));
}

// Measured from a camera that is in truth the other one, all others are elsewhere.
TEST(Exchanged, TheReferenceAndAnotherCamera) {
  const Se3 left = At({0, 0.3, 0}, 20 * kDegree), top = At({0.1, 0.1, 0.6}), rear = At({-1, 0, 0}, M_PI);
  const Se3 from_left = left.Inverse();
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("left", SensorKind::kCamera, left, from_left);
  drawn.Add("top", SensorKind::kLidar, top, from_left * top);
  drawn.Add("rear", SensorKind::kCamera, rear, from_left * rear);
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_THAT(causes[0].sensors, ElementsAre(SensorId("base"), SensorId("left")));
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kFail);
}

TEST(Exchanged, ACameraIsNeverTakenForALidar) {
  Drawn drawn = WithReference();
  drawn.Add("front", SensorKind::kCamera, kLeft, kRight);
  drawn.Add("low", SensorKind::kLidar, kRight, kLeft);
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kFarFromNominal);
}

TEST(FarFromNominal, OneSensorWarnsWithHowFar) {
  Drawn drawn = WithReference();
  drawn.Add("lidar_vertical", SensorKind::kLidar, At({0, 0, 1}), At({0.221, 0, 1}, 3 * kDegree));
  drawn.Add("front", SensorKind::kCamera, kLeft, kLeft);
  const RootCause cause = drawn.Causes().at(0);
  EXPECT_EQ(cause.said.why, "lidar_vertical sits 221 mm and 3 deg from where the drawing has it");
  EXPECT_EQ(cause.said.what_to_do,
            "Check the name and the mount of lidar_vertical, or correct its T_ref_nominal in session.yaml");
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kWarn);
  EXPECT_THAT(drawn.Judge().why, StartsWith("lidar_vertical sits 221 mm"));
}

TEST(FarFromNominal, ATurnAloneIsEnough) {
  Drawn drawn = WithReference();
  drawn.Add("rear", SensorKind::kCamera, kLeft, kLeft * At({0, 0, 0}, 6 * kDegree));
  EXPECT_EQ(drawn.Causes().at(0).said.why, "rear sits 0 mm and 6 deg from where the drawing has it");
  Drawn less = WithReference();
  less.Add("rear", SensorKind::kCamera, kLeft, kLeft * At({0.04, 0, 0}, 4 * kDegree));
  EXPECT_THAT(less.Causes(), SizeIs(0));
}

TEST(FarFromNominal, WhatIsKnownNoBetterIsNotFar) {
  for (const auto& [sigma_m, causes] : {std::pair{0.021, 0U}, {0.019, 1U}}) {
    Drawn drawn = WithReference();
    drawn.Add("rear", SensorKind::kCamera, kLeft, kLeft * At({0.1, 0, 0}), sigma_m);
    EXPECT_THAT(drawn.Causes(), SizeIs(causes)) << sigma_m;
  }
}

TEST(FarFromNominal, SeveralAreOneLineAndAllOfThemTellOfTheReference) {
  Drawn drawn = WithReference();
  drawn.Add("a", SensorKind::kCamera, At({1, 0, 0}), At({1.1, 0, 0}));
  drawn.Add("b", SensorKind::kCamera, At({0, 1, 0}), At({0, 1.3, 0}));
  EXPECT_EQ(drawn.Causes().at(0).said.why, "b and a sit elsewhere than the drawing has them, b by 300 mm and 0 deg");
  EXPECT_THAT(drawn.Causes().at(0).said.what_to_do, StartsWith("Check their names and their mounts"));
  drawn.Add("c", SensorKind::kLidar, At({0, 0, 1}), At({0, 0.2, 1}));
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  EXPECT_EQ(drawn.Causes().at(0).said.what_to_do, "Check the name and the mount of base, from which all are measured");
}

TEST(FarFromNominal, IsSaidFirstWhereEdgesDisagreeAroundIt) {
  Rig rig;
  for (Edge& edge : rig.edges) edge.session = SessionId(std::string(64, '1'));
  Visit visit{StereoBoard()};
  for (const char* name : {"left", "right", "top"}) visit.AddSensor(name, SensorKind::kCamera);
  for (Sensor& sensor : visit.header.sensors) sensor.T_ref_nominal = Se3();
  visit.header.sensors[2].T_ref_nominal = At({0.5, 0, 0});
  rig.solution.residuals[1] = ResidualOf(rig.edges[1], 0.03);  // right - top
  const Verdict around = Assess(rig.edges, rig.solution, {}, {}, {}, visit.Headers());
  EXPECT_EQ(around.level, VerdictLevel::kFail);
  EXPECT_THAT(around.why,
              StartsWith("top sits 500 mm and 0 deg from where the drawing has it; also, right and top do not "
                         "fit the other measurements: 30 mm, 0 deg off"));
  rig.solution.residuals[1] = ResidualOf(rig.edges[1], 0.0005);
  rig.solution.residuals[0] = ResidualOf(rig.edges[0], 0.03);  // left - right
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {}, visit.Headers()).why, Not(HasSubstr("drawing")));
}

TEST(FarFromNominal, DrawingsOfPastSessionsAndOfOtherReferencesDoNotCount) {
  Drawn drawn = WithReference();
  drawn.Add("rear", SensorKind::kCamera, kLeft, kRight);
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  SessionHeaders headers = drawn.visit.Headers();
  SessionHeader& newer = headers[SessionId(std::string(64, '2'))];
  newer = drawn.visit.header;
  newer.captured_at.ns += 1;
  newer.sensors[1].T_ref_nominal = kRight;
  std::vector<Edge> edges = drawn.visit.edges;
  EXPECT_THAT(FindRootCauses(edges, drawn.solution, headers, {}), SizeIs(1)) << "no edge is of the newer one";
  edges.push_back(edges.front());
  edges.back().session = SessionId(std::string(64, '2'));
  EXPECT_THAT(FindRootCauses(edges, drawn.solution, headers, {}), SizeIs(0)) << "the newest drawing counts";
  edges.back().state = EdgeState::kFailed;
  edges.back().diagnoses = {{std::string(kSupersededCode), "it is past", ""}};
  EXPECT_THAT(FindRootCauses(edges, drawn.solution, headers, {}), SizeIs(1));
  for (auto& [session, header] : headers) header.sensors.front().id = SensorId("another");
  EXPECT_THAT(FindRootCauses(drawn.visit.edges, drawn.solution, headers, {}), SizeIs(0));
}

// One edge from "left" to "rear", which leaves these axes of rear open.
struct OpenRig {
  std::vector<Edge> edges;
  GraphSolution solution = SolutionOf({"left"}, {"rear"});

  OpenRig(const Se3& T_left_rear, const std::vector<int>& axes) {
    Edge edge = MakeEdge('a', "left", "rear");
    edge.T_a_b = T_left_rear;
    Matrix6d Omega = edge.uncertainty.Omega;
    for (const int axis : axes) Omega(axis, axis) = 0.0;
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    edges.push_back(edge);
    for (const int axis : axes) solution.poses[1].unobservable_basis.push_back(Vector6d::Unit(axis));
  }
  [[nodiscard]] PartialPose Told(SensorKind reference) const {
    Visit visit(StereoBoard());
    visit.AddSensor("left", reference);
    return PartialPoseOf(solution.poses[1], edges, solution, visit.Headers());
  }
};

TEST(PartialPoses, NameTheAxisOfTheRobotInTheReference) {
  Se3 upright;  // x of the sensor is up
  upright.q = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY());
  EXPECT_EQ(OpenRig(upright, {tangent::kX}).Told(SensorKind::kLidar).open, "the height");
  EXPECT_EQ(OpenRig({}, {tangent::kX}).Told(SensorKind::kLidar).open, "the forward position");
  EXPECT_EQ(OpenRig({}, {tangent::kY}).Told(SensorKind::kLidar).open, "the sideways position");
  EXPECT_EQ(OpenRig({}, {tangent::kRz}).Told(SensorKind::kLidar).open, "the yaw");
  EXPECT_EQ(OpenRig(At({0, 0, 0}, 8 * kDegree), {tangent::kX}).Told(SensorKind::kLidar).open, "the forward position");
  EXPECT_EQ(OpenRig(At({0, 0, 0}, 12 * kDegree), {tangent::kX}).Told(SensorKind::kLidar).open, "one direction");
}

TEST(PartialPoses, ACameraLooksAlongItsZ) {
  EXPECT_EQ(OpenRig({}, {tangent::kZ}).Told(SensorKind::kCamera).open, "the forward position");
  EXPECT_EQ(OpenRig({}, {tangent::kX}).Told(SensorKind::kCamera).open, "the sideways position");
  EXPECT_EQ(OpenRig({}, {tangent::kY}).Told(SensorKind::kCamera).open, "the height");
  EXPECT_EQ(OpenRig({}, {tangent::kRy}).Told(SensorKind::kCamera).open, "the yaw");
}

TEST(PartialPoses, TellHowWellTheRestIsKnown) {
  const PartialPose one = OpenRig(At({0.3, 0, 0}, 0.4), {tangent::kZ}).Told(SensorKind::kLidar);
  ASSERT_TRUE(one.sigma_m && one.sigma_rad);
  EXPECT_NEAR(*one.sigma_m, 1e-3, 1e-9);
  EXPECT_NEAR(*one.sigma_rad, 1e-3, 1e-9);
  EXPECT_FALSE(one.several);
  const PartialPose two = OpenRig({}, {tangent::kX, tangent::kZ}).Told(SensorKind::kLidar);
  EXPECT_EQ(two.open, "the forward position and the height");
  EXPECT_TRUE(two.several && two.sigma_m);
  EXPECT_FALSE(OpenRig({}, {tangent::kRz}).Told(SensorKind::kLidar).sigma_m);
  OpenRig apart({}, {tangent::kZ});
  apart.edges.clear();  // tied by others that are not known
  EXPECT_EQ(apart.Told(SensorKind::kLidar).open, "one direction");
}

TEST(PartialPoses, AreAResultInTheVerdict) {
  OpenRig rig({}, {tangent::kZ});
  const Verdict verdict = Assess(rig.edges, rig.solution);
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.why, "The height of rear was not measured; the rest was, to 1 mm and 0.057 deg.");
  EXPECT_EQ(verdict.what_to_do, "Capture rear again, with boards and motion in every direction.");
  EXPECT_THAT(
      Assess(OpenRig({}, {tangent::kX, tangent::kY}).edges, OpenRig({}, {tangent::kX, tangent::kY}).solution).why,
      StartsWith("The forward position and the sideways position of rear were not measured; the rest was, to 1 mm"));
}

}  // namespace
}  // namespace rigcal::fleet

// Sensors that are not where the drawing has them, and poses that are known but for some directions.
#include <gmock/gmock.h>

#include "server/fleet/findings/partial_poses.h"
#include "server/model/edges/past.h"
#include "tests/unit/fleet/causes/drawn.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

const Se3 kLeft = At({1, 0.211, 0.5});

TEST(FarFromNominal, OneSensorWarnsWithHowFar) {
  Drawn drawn = WithReference();
  drawn.Add("lidar_vertical", SensorKind::kLidar, At({0, 0, 1}), At({0.621, 0, 1}, 3 * kDegree));
  drawn.Add("front", SensorKind::kCamera, kLeft, kLeft);
  const RootCause cause = drawn.Causes().at(0);
  EXPECT_EQ(cause.said.why, "lidar_vertical sits 621 mm and 3 deg from its nominal (CAD) pose");
  EXPECT_EQ(cause.said.what_to_do,
            "Check the name and the mount of lidar_vertical, or correct its T_ref_nominal in session.yaml");
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kWarn);
  EXPECT_THAT(drawn.Judge().why, StartsWith("lidar_vertical sits 621 mm"));
}

TEST(FarFromNominal, ATurnAloneIsEnough) {
  Drawn drawn = WithReference();
  drawn.Add("rear", SensorKind::kCamera, kLeft, kLeft * At({0, 0, 0}, 11 * kDegree));
  EXPECT_EQ(drawn.Causes().at(0).said.why, "rear sits 0 mm and 11 deg from its nominal (CAD) pose");
  Drawn less = WithReference();
  less.Add("rear", SensorKind::kCamera, kLeft, kLeft * At({0.49, 0, 0}, 9 * kDegree));
  EXPECT_THAT(less.Causes(), SizeIs(0));
}

TEST(FarFromNominal, OfASensorKnownInPartOnlyWhatWasMeasuredCounts) {
  const Vector6d height = Vector6d::Unit(tangent::kZ), yaw = Vector6d::Unit(tangent::kRz);
  Drawn high = WithReference();
  high.Add("body", SensorKind::kTracker, At({0.5, 0, 0.2}), At({0.5, 0, 0.2}));
  high.LeaveOpen(height, 3.0);
  EXPECT_THAT(high.Causes(), SizeIs(0));
  high.LeaveOpen(yaw, 2.5);
  EXPECT_THAT(high.Causes(), SizeIs(0));
  Drawn ahead = WithReference();
  ahead.Add("front", SensorKind::kCamera, kLeft, kLeft);
  ahead.Add("body", SensorKind::kTracker, At({0.5, 0, 0.2}), At({1.1, 0, 0.2}));
  ahead.LeaveOpen(height, 3.0);
  ASSERT_THAT(ahead.Causes(), SizeIs(1));
  EXPECT_EQ(ahead.Causes()[0].said.why,
            "body sits 600 mm and 0 deg from its nominal (CAD) pose, by what was measured of it");
  EXPECT_THAT(ahead.Judge().why, StartsWith("body sits 600 mm")) << "and not only that its height was not measured";
  EXPECT_EQ(ahead.Judge().unverified, "body");
}

// A warning by itself; but who is told what not to rely on is told of it.
TEST(FarFromNominal, IsNotToBeReliedOnWhereOthersAreNot) {
  Drawn drawn = WithReference();
  drawn.Add("front", SensorKind::kCamera, kLeft, kLeft);
  drawn.Add("lidar", SensorKind::kLidar, At({0, 0, 1}), At({0.621, 0, 1}, 3 * kDegree));
  drawn.Add("body", SensorKind::kTracker, At({0.5, 0, 0.2}), At({0.5, 0, 0.2}));
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kWarn);
  drawn.LeaveOpen(Vector6d::Unit(tangent::kZ));
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kUnknown);
  EXPECT_EQ(drawn.Judge().unverified, "body and lidar");
}

TEST(FarFromNominal, IsNotToBeReliedOnWhereOthersAreKnownTooLittle) {
  Drawn drawn = WithReference();
  drawn.Add("front", SensorKind::kCamera, kLeft, kLeft);
  drawn.Add("lidar", SensorKind::kLidar, At({0, 0, 1}), At({0.621, 0, 1}, 3 * kDegree));
  drawn.Add("body", SensorKind::kTracker, At({0.5, 0, 0.2}), At({0.5, 0, 0.2}), 0.008);
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kUnknown);
  EXPECT_THAT(drawn.Judge().unverified, StartsWith("body ("));
  EXPECT_THAT(drawn.Judge().unverified, testing::EndsWith("), lidar"));
}

TEST(FarFromNominal, WhatIsKnownNoBetterIsNotFar) {
  for (const auto& [sigma_m, causes] : {std::pair{0.121, 0U}, {0.119, 1U}}) {
    Drawn drawn = WithReference();
    drawn.Add("rear", SensorKind::kCamera, kLeft, kLeft * At({0.6, 0, 0}), sigma_m);
    EXPECT_THAT(drawn.Causes(), SizeIs(causes)) << sigma_m;
  }
}

TEST(FarFromNominal, SeveralAreOneLineAndAllOfThemTellOfTheReference) {
  Drawn drawn = WithReference();
  drawn.Add("a", SensorKind::kCamera, At({1, 0, 0}), At({1.6, 0, 0}));
  drawn.Add("b", SensorKind::kCamera, At({0, 1, 0}), At({0, 1.8, 0}));
  EXPECT_EQ(drawn.Causes().at(0).said.why,
            "b and a do not sit at their nominal (CAD) poses: b is off by 800 mm and 0 deg");
  EXPECT_THAT(drawn.Causes().at(0).said.what_to_do, StartsWith("Check their names and their mounts"));
  drawn.Add("c", SensorKind::kLidar, At({0, 0, 1}), At({0, 0.7, 1}));
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  EXPECT_EQ(drawn.Causes().at(0).said.what_to_do, "Check the name and the mount of base, from which all are measured");
}

// One sensor's position in millimetres, the others' in metres.
TEST(NominalUnit, OneInMillimetresIsNamedAsThat) {
  Drawn drawn = WithReference();
  drawn.Add("rear", SensorKind::kCamera, At({38, -9, 4}), At({0.0381, -0.0092, 0.0038}));
  drawn.Add("front", SensorKind::kCamera, kLeft, kLeft);
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  const RootCause cause = drawn.Causes().front();
  EXPECT_EQ(cause.kind, CauseKind::kNominalUnit);
  EXPECT_EQ(cause.said.why,
            "the nominal (CAD) pose of rear looks like millimetres: rear is given 39.3 m from base and measured 0.0394 "
            "m from it");
  EXPECT_EQ(FindingOf(cause).what_to_do,
            "Give T_ref_nominal of rear in session.yaml in metres, then `rigcal push FOLDER`");
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kWarn);
}

TEST(NominalUnit, AllOfThemAreOneLine) {
  Drawn drawn = WithReference();
  drawn.Add("rear", SensorKind::kCamera, At({38, -9, 4}), At({0.038, -0.009, 0.004}));
  drawn.Add("front", SensorKind::kCamera, At({-40, 20, 0}), At({-0.041, 0.02, 0.001}));
  drawn.Add("top", SensorKind::kLidar, At({0, 0, 45}), At({0, 0, 0.045}));
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  EXPECT_THAT(drawn.Causes().front().sensors, SizeIs(3));
  EXPECT_EQ(drawn.Causes().front().kind, CauseKind::kNominalUnit);
}

// Of one that is known in part the rest holds the drawing's own millimetres.
TEST(NominalUnit, IsSeenInWhatWasMeasured) {
  Drawn drawn = WithReference();
  drawn.Add("rear", SensorKind::kCamera, At({38, -9, 4}), At({0.0381, -0.0092, 0.0038}));
  drawn.LeaveOpen(Vector6d::Unit(tangent::kZ), 3.9962);
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  EXPECT_EQ(drawn.Causes().front().kind, CauseKind::kNominalUnit);
  EXPECT_THAT(drawn.Causes().front().said.why,
              HasSubstr("given 39.3 m from base and measured 0.0394 m from it, by what was measured of it"));
}

TEST(NominalUnit, WhatIsFarInAnotherWayIsNot) {
  for (const auto& [given, found] : {std::pair{At({38, 9, 4}), At({0.038, -0.009, 0.004})},  // another direction
                                     {At({3.8, 0, 0}), At({0.038, 0, 0})},                   // centimetres
                                     {At({0.9, 0, 0}), At({0.0009, 0, 0})},                  // at the reference
                                     {At({12, 0, 0}), At({0.038, 0, 0})}}) {
    Drawn drawn = WithReference();
    drawn.Add("rear", SensorKind::kCamera, given, found);
    ASSERT_THAT(drawn.Causes(), SizeIs(1)) << given.p_m.transpose();
    EXPECT_EQ(drawn.Causes().front().kind, CauseKind::kFarFromNominal) << given.p_m.transpose();
  }
  Drawn rough = WithReference();
  rough.Add("rear", SensorKind::kCamera, At({38, 0, 0}), At({0.038, 0, 0}), 0.02);
  for (const RootCause& cause : rough.Causes()) EXPECT_NE(cause.kind, CauseKind::kNominalUnit) << "hardly measured";
}

// A robot in which all is well but the drawing of "top", which is found at the reference.
struct RoughlyDrawn {
  Rig rig;
  Visit visit{StereoBoard()};

  explicit RoughlyDrawn(const Se3& top) {
    for (Edge& edge : rig.edges) edge.session = visit.session;
    for (const char* name : {"left", "right", "top"}) visit.AddSensor(name, SensorKind::kCamera);
    for (Sensor& sensor : visit.header.sensors) sensor.T_ref_nominal = Se3();
    visit.header.sensors[2].T_ref_nominal = top;
  }
  [[nodiscard]] Verdict Judge() const { return Assess(rig.edges, rig.solution, {}, {}, {}, visit.Headers()); }
};

// docs/session-format.md asks for no more of a drawing.
TEST(FarFromNominal, ADrawingThatIsRightToHalfAMetreAndTenDegreesIsNoWarning) {
  EXPECT_EQ(RoughlyDrawn(At({0.3, 0, 0}, 8 * kDegree)).Judge().level, VerdictLevel::kPass);
  const Verdict worse = RoughlyDrawn(At({0.6, 0, 0})).Judge();
  EXPECT_EQ(worse.level, VerdictLevel::kWarn);
  EXPECT_EQ(worse.why, "top sits 600 mm and 0 deg from its nominal (CAD) pose.");
}

TEST(FarFromNominal, IsSaidFirstWhereEdgesDisagreeAroundIt) {
  for (const auto& [far_m, told] : {std::pair{0.6, "600 mm"}, {0.1, "100 mm"}}) {
    RoughlyDrawn robot(At({far_m, 0, 0}));
    std::vector<EdgeResidual>& residuals = robot.rig.solution.residuals;
    residuals[1] = ResidualOf(robot.rig.edges[1], 0.03);  // right - top
    const Verdict around = robot.Judge();
    EXPECT_EQ(around.level, VerdictLevel::kFail);
    EXPECT_THAT(around.why, StartsWith(std::string("top sits ") + told +
                                       " and 0 deg from its nominal (CAD) pose; also, right - top does not fit the "
                                       "other pairs: 30 mm, 0 deg off"));
    residuals[1] = ResidualOf(robot.rig.edges[1], 0.0005);
    residuals[0] = ResidualOf(robot.rig.edges[0], 0.03);  // left - right
    EXPECT_THAT(robot.Judge().why, Not(HasSubstr("drawing")));
  }
}

TEST(FarFromNominal, ADrawingThatIsRightIsNotNamedWhereEdgesDisagree) {
  RoughlyDrawn robot(At({0.04, 0, 0}, 4 * kDegree));
  robot.rig.solution.residuals[1] = ResidualOf(robot.rig.edges[1], 0.03);
  EXPECT_THAT(robot.Judge().why, StartsWith("right - top does not fit"));
}

TEST(FarFromNominal, DrawingsOfPastSessionsAndOfOtherReferencesDoNotCount) {
  Drawn drawn = WithReference();
  const Se3 found = At({1, -0.4, 0.5});
  drawn.Add("rear", SensorKind::kCamera, kLeft, found);
  ASSERT_THAT(drawn.Causes(), SizeIs(1));
  SessionHeaders headers = drawn.visit.Headers();
  SessionHeader& newer = headers[SessionId(std::string(64, '2'))];
  newer = drawn.visit.header;
  newer.captured_at.ns += 1;
  newer.sensors[1].T_ref_nominal = found;
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
    solution.poses[1].measured_part = MeasuredPart{T_left_rear, edge.uncertainty.covariance};
    for (const int axis : axes) solution.poses[1].unobservable_basis.push_back(Vector6d::Unit(axis));
  }
  [[nodiscard]] PartialPose Told(const SessionHeaders& headers) const {
    return PartialPoseOf(solution.poses[1], solution, headers);
  }
  [[nodiscard]] PartialPose Told(SensorKind reference) const {
    Visit visit(StereoBoard());
    visit.AddSensor("left", reference);
    return Told(visit.Headers());
  }
};

TEST(PartialPoses, NameTheAxisOfTheRobotWhereABodyIsTheReference) {
  Se3 upright;  // x of the sensor is up
  upright.q = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY());
  const SensorKind body = SensorKind::kTracker;
  EXPECT_EQ(OpenRig(upright, {tangent::kX}).Told(body).open, "the height");
  EXPECT_EQ(OpenRig({}, {tangent::kX}).Told(body).open, "the forward position");
  EXPECT_EQ(OpenRig({}, {tangent::kY}).Told(SensorKind::kPoseStream).open, "the sideways position");
  EXPECT_EQ(OpenRig({}, {tangent::kRz}).Told(body).open, "the yaw");
  EXPECT_EQ(OpenRig({}, {tangent::kRz}).Told(body).frame, "");
  EXPECT_EQ(OpenRig(At({0, 0, 0}, 8 * kDegree), {tangent::kX}).Told(body).open, "the forward position");
  EXPECT_EQ(OpenRig(At({0, 0, 0}, 12 * kDegree), {tangent::kX}).Told(body).open, "one direction");
}

// A camera may look up, and a lidar lie on its side.
TEST(PartialPoses, NameTheAxisOfTheReferenceWhereNothingTellsHowItIsMounted) {
  const PartialPose of_camera = OpenRig({}, {tangent::kZ}).Told(SensorKind::kCamera);
  EXPECT_EQ(of_camera.open, "the position along z");
  EXPECT_EQ(of_camera.frame, "the frame of left (x right, y down, z along its view)");
  const PartialPose of_lidar = OpenRig({}, {tangent::kX, tangent::kRy}).Told(SensorKind::kLidar);
  EXPECT_EQ(of_lidar.open, "the position along x and the turn about y");
  EXPECT_EQ(of_lidar.frame, "the frame of left");
  const PartialPose askew = OpenRig(At({0, 0, 0}, 45 * kDegree), {tangent::kX}).Told(SensorKind::kLidar);
  EXPECT_EQ(askew.open, "one direction");
  EXPECT_EQ(askew.frame, "") << "it names no axis";
  EXPECT_FALSE(RobotAxes(SensorId("left"), {}));
}

TEST(PartialPoses, ADrawnBodyTellsHowACameraIsMounted) {
  Visit visit(StereoBoard());
  visit.AddSensor("left", SensorKind::kCamera);
  visit.AddSensor("body", SensorKind::kTracker);
  const OpenRig rig({}, {tangent::kZ});
  EXPECT_EQ(rig.Told(visit.Headers()).open, "the position along z") << "the body is not drawn";
  Se3& T_camera_body = visit.header.sensors[1].T_ref_nominal.emplace();
  T_camera_body.q = (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();  // the camera looks ahead
  EXPECT_EQ(rig.Told(visit.Headers()).open, "the forward position");
  T_camera_body.q.setIdentity();  // up
  EXPECT_EQ(rig.Told(visit.Headers()).open, "the height");
  visit.AddSensor("odometry", SensorKind::kPoseStream);
  visit.header.sensors[2].T_ref_nominal = T_camera_body;
  visit.header.sensors[1].T_ref_nominal->q = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
  EXPECT_EQ(rig.Told(visit.Headers()).open, "the height")
      << "odometry is held for upright sooner than a tracker's body";
}

TEST(PartialPoses, TellHowWellTheRestIsKnown) {
  const PartialPose one = OpenRig(At({0.3, 0, 0}, 0.4), {tangent::kZ}).Told(SensorKind::kTracker);
  ASSERT_TRUE(one.sigma_m && one.sigma_rad);
  EXPECT_NEAR(*one.sigma_m, 1e-3, 1e-9);
  EXPECT_NEAR(*one.sigma_rad, 1e-3, 1e-9);
  EXPECT_FALSE(one.several);
  const PartialPose two = OpenRig({}, {tangent::kX, tangent::kZ}).Told(SensorKind::kTracker);
  EXPECT_EQ(two.open, "the forward position and the height");
  EXPECT_TRUE(two.several && two.sigma_m);
  const PartialPose turn = OpenRig({}, {tangent::kRz}).Told(SensorKind::kTracker);
  EXPECT_EQ(turn.open, "the yaw");
  EXPECT_TRUE(turn.sigma_m && turn.sigma_rad);
  EXPECT_FALSE(OpenRig({}, {tangent::kX, tangent::kY, tangent::kZ}).Told(SensorKind::kLidar).sigma_m);
  OpenRig without({}, {tangent::kZ});
  without.solution.poses[1].measured_part.reset();
  EXPECT_EQ(without.Told(SensorKind::kLidar).open, "one direction");
}

TEST(PartialPoses, AreAResultInTheVerdict) {
  const OpenRig rig({}, {tangent::kZ});
  const Verdict verdict = Assess(rig.edges, rig.solution);
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.why,
            "The position along z of rear in the frame of left was not measured; the rest was, to 1 mm and 0.057 deg.");
  EXPECT_EQ(verdict.what_to_do, "Capture rear again, with boards and motion in every direction.");
  Visit visit(StereoBoard());
  visit.AddSensor("left", SensorKind::kTracker);
  const OpenRig level({}, {tangent::kX, tangent::kY});
  EXPECT_THAT(
      Assess(level.edges, level.solution, {}, {}, {}, visit.Headers()).why,
      StartsWith("The forward position and the sideways position of rear were not measured; the rest was, to 1 mm"));
}

}  // namespace
}  // namespace rigcal::fleet

// What a robot lacks of its rig model: each sentence, and what is no lack.
#include "server/fleet/causes/rig_causes.h"

#include <gmock/gmock.h>

#include "server/fleet/causes/told_causes.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// left and right, which one good edge joins; right sits 200 mm along x of left, as drawn.
struct NominalPair {
  ExpectedRig expected;
  std::vector<Edge> edges;
  GraphSolution solution;
  SessionHeaders headers;
  std::set<SensorId> retired;

  NominalPair() {
    RigModel& model = expected.model;
    model.name = "mars";
    model.reference = SensorId("left");
    model.sensors = {{SensorId("left"), SensorKind::kCamera, Se3(), {}},
                     {SensorId("right"), SensorKind::kCamera, At(0.2), PoseLimit{0.01, 0.02}}};
    AddPose("left", Se3());
    AddPose("right", At(0.2));
    Edge edge;
    edge.id = EdgeId(std::string(64, 'a'));
    edge.frame_a = SensorId("left"), edge.frame_b = SensorId("right");
    edge.state = EdgeState::kGood;
    edges = {edge};
  }
  static Se3 At(double x_m) { return {{x_m, 0.0, 0.0}, Eigen::Quaterniond::Identity()}; }
  void AddPose(const std::string& sensor, const Se3& T) {
    SensorPose pose;
    pose.sensor = SensorId(sensor);
    pose.known = true;
    pose.T_ref_sensor = T;
    if (sensor != "left") pose.covariance = Matrix6d::Identity() * 1e-10;
    solution.poses.push_back(pose);
  }
  void Expect(const std::string& sensor, SensorKind kind = SensorKind::kCamera) {
    expected.model.sensors.push_back({SensorId(sensor), kind, {}, {}});
  }
  [[nodiscard]] std::vector<Cause> Causes() const {
    return ToldCauses(FindRootCauses(edges, solution, headers, {}, expected, retired));
  }
};

TEST(RigCauses, ARobotThatHasAllHasNone) {
  EXPECT_THAT(NominalPair().Causes(), IsEmpty());
  NominalPair other;
  other.AddPose("body", NominalPair::At(1.0));
  EXPECT_THAT(other.Causes(), IsEmpty()) << "what the model does not have is nobody's business";
}

TEST(RigCauses, ASensorThatNothingNamesIsMissed) {
  NominalPair rig;
  rig.Expect("imu_front");
  const auto causes = rig.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].why, "imu_front is in rig model mars but not here.");
  EXPECT_EQ(causes[0].kind, "sensor_missing");
  EXPECT_EQ(causes[0].key, "sensor_missing imu_front");
  rig.retired = {SensorId("imu_front")};
  EXPECT_THAT(rig.Causes(), IsEmpty()) << "it was taken off on purpose";
  rig.retired.clear();
  rig.AddPose("imu_front", NominalPair::At(0.1));
  EXPECT_THAT(rig.Causes(), IsEmpty());
}

TEST(RigCauses, SeveralAreOneSentence) {
  NominalPair rig;
  rig.Expect("imu"), rig.Expect("top");
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].why, "imu and top are in rig model mars but not here.");
}

TEST(RigCauses, ASensorKnownInPartIsHeldAgainstItsPlaceByWhatWasMeasured) {
  NominalPair rig;
  SensorPose& right = rig.solution.poses.back();
  right.known = false;
  right.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  right.measured_part = MeasuredPart{{{0.2, 0.0, 1.0}, Eigen::Quaterniond::Identity()}, Matrix6d::Identity() * 1e-10};
  EXPECT_THAT(rig.Causes(), IsEmpty()) << "its height was not measured";
  right.measured_part->T_ref_sensor.p_m.x() = 0.25;
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].why,
            "right sits 50 mm and 0 deg from where rig model mars has it (10 mm and 1.1 deg allowed), by what was "
            "measured of it.");
}

TEST(RigCauses, AnotherKindIsTold) {
  NominalPair rig;
  SessionHeader header;
  Sensor lidar;
  lidar.id = SensorId("right");
  lidar.kind = SensorKind::kLidar;
  header.sensors = {lidar};
  rig.edges[0].session = SessionId(std::string(64, '1'));
  rig.headers[rig.edges[0].session] = header;
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].why, "right is a camera in rig model mars but a lidar here.");
  EXPECT_EQ(rig.Causes()[0].kind, "sensor_kind");
}

TEST(RigCauses, ARequiredPairNeedsAGoodEdge) {
  NominalPair rig;
  rig.expected.model.required_pairs = {{SensorId("right"), SensorId("left")}};
  EXPECT_THAT(rig.Causes(), IsEmpty()) << "in either order";
  rig.AddPose("top", NominalPair::At(0.5));
  rig.Expect("top");
  rig.expected.model.required_pairs.push_back({SensorId("left"), SensorId("top")});
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].why, "Rig model mars requires left - top, which has no good edge here.");
  EXPECT_EQ(rig.Causes()[0].key, "pair_missing left top");
}

TEST(RigCauses, OfASensorThatIsMissingThePairIsNotAskedFor) {
  NominalPair rig;
  rig.Expect("top");
  rig.expected.model.required_pairs = {{SensorId("left"), SensorId("top")}};
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].kind, "sensor_missing");
}

TEST(RigCauses, APoseOffTheDrawingIsToldWithBothNumbers) {
  NominalPair rig;
  rig.solution.poses[1].T_ref_sensor = NominalPair::At(0.2095);
  EXPECT_THAT(rig.Causes(), IsEmpty()) << "within the tolerance";
  rig.solution.poses[1].T_ref_sensor = NominalPair::At(0.2142);
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].why,
            "right sits 14.2 mm and 0 deg from where rig model mars has it (10 mm and 1.1 deg allowed).");
  EXPECT_EQ(rig.Causes()[0].key, "off_rig_model right");
  rig.solution.poses[1].T_ref_sensor = NominalPair::At(0.2) * Se3::Exp(Vector6d::Unit(5) * 0.03);
  EXPECT_THAT(rig.Causes()[0].why, HasSubstr("0 mm and 1.72 deg"));
}

// The robot's reference is right, not the model's: the drawing is turned over to it.
TEST(RigCauses, TheDrawingIsSeenFromTheRobotsReference) {
  NominalPair rig;
  rig.solution.poses.clear();
  SensorPose right;
  right.sensor = SensorId("right"), right.known = true;
  SensorPose left;
  left.sensor = SensorId("left"), left.known = true, left.T_ref_sensor = NominalPair::At(-0.2),
  left.covariance = Matrix6d::Identity() * 1e-10;
  rig.solution.poses = {right, left};
  EXPECT_THAT(rig.Causes(), IsEmpty());
  rig.solution.poses[1].T_ref_sensor = NominalPair::At(-0.23);
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_EQ(rig.Causes()[0].why,
            "left sits 30 mm and 0 deg from where rig model mars has it (10 mm and 1.1 deg allowed).");
}

TEST(RigCauses, AReferenceThatIsNotDrawnIsTold) {
  NominalPair rig;
  SensorPose base;
  base.sensor = SensorId("base"), base.known = true;
  rig.solution.poses[0].covariance = Matrix6d::Identity() * 1e-10;
  rig.solution.poses.insert(rig.solution.poses.begin(), base);
  ASSERT_THAT(rig.Causes(), SizeIs(1));
  EXPECT_THAT(rig.Causes()[0].why, HasSubstr("base, from which all poses are told, has no place in rig model mars"));
}

TEST(RigCauses, ASessionIsAskedWhatItLists) {
  NominalPair rig;
  rig.Expect("top");
  SessionHeader header;
  header.sensors.emplace_back().id = SensorId("left");
  EXPECT_EQ(LackingOf(header, rig.expected.model, {}), "right and top are in rig model mars but not here");
  EXPECT_EQ(LackingOf(header, rig.expected.model, {SensorId("right"), SensorId("top")}), "");
  EXPECT_EQ(LackingOf(header, RigModel(), {}), "");
}

}  // namespace
}  // namespace rigcal::fleet

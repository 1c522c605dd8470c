#include "server/model/edges/unit_doubt.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

using Eigen::Vector3d;

Sensor SensorAt(const std::string& name, const Vector3d& p_m) {
  Sensor sensor;
  sensor.id = SensorId(name);
  sensor.T_ref_nominal = Se3{p_m, Eigen::Quaterniond::Identity()};
  return sensor;
}

// The reference is not drawn.
SessionHeader RigOf(const std::vector<Sensor>& drawn) {
  SessionHeader header;
  header.reference = SensorId("front_left");
  header.sensors.emplace_back().id = header.reference;
  header.sensors.insert(header.sensors.end(), drawn.begin(), drawn.end());
  return header;
}

Edge EdgeAlong(const std::string& a, const std::string& b, double x_m) {
  Edge edge;
  edge.frame_a = SensorId(a);
  edge.frame_b = SensorId(b);
  edge.T_a_b.p_m.x() = x_m;
  edge.state = EdgeState::kGood;
  return edge;
}

TimedPose Row(const std::string& capture, double x_m) {
  TimedPose row;
  row.capture = CaptureId(capture);
  row.T_world_body.p_m.x() = x_m;
  return row;
}

TEST(UnitDoubt, NamesTheTwoSensorsThatAreFarthestApart) {
  EXPECT_EQ(UnitDoubt(RigOf({SensorAt("top", {0, 0, 210}), SensorAt("back", {0, -80, 0})})),
            "225 m between back and top: are these millimetres?");
  EXPECT_EQ(UnitDoubt(RigOf({SensorAt("top", {0, 60, 0})})), "60 m between front_left and top: are these millimetres?");
  EXPECT_EQ(UnitDoubt(RigOf({SensorAt("top", {0, 30, 40}), SensorAt("back", {1, 0, 0})})).substr(0, 5), "50 m ");
  EXPECT_EQ(UnitDoubt(RigOf({SensorAt("top", {0, 30, 40})})), "");
  EXPECT_EQ(UnitDoubt(RigOf({})), "");
}

TEST(UnitDoubt, AMixtureIsNamedWithWhatIsInWhich) {
  EXPECT_EQ(UnitDoubt(RigOf({SensorAt("top", {0, 0, 210}), SensorAt("left", {0, 0.3, 0.1}),
                             SensorAt("rear", {-0.9, 0, 0}), SensorAt("back", {0, -80, 0})})),
            "225 m between back and top: are back and top in millimetres, and left and rear in metres?");
  EXPECT_EQ(Sentence(CheckSensorsApart(RigOf({SensorAt("top", {0, 0, 210}), SensorAt("left", {0, 0.3, 0.1})})).error()),
            "T_ref_nominal: 210 m between front_left and top: is top in millimetres, and left in metres? Give p_m in "
            "metres.");
  EXPECT_EQ(UnitDoubt(PoseTable{Row("01", 1.2), Row("02", 1300.0), Row("03", 1.4), Row("04", 1500.0), Row("05", 1.6)}),
            "1499 m between captures 03 and 04: are captures 02 and 04 in millimetres, and captures 01, 03 and 05 in "
            "metres?");
  EXPECT_EQ(UnitDoubt(std::vector<Edge>{EdgeAlong("a", "b", 0.8), EdgeAlong("b", "c", 700.0)}),
            "700 m between b and c: is b - c in millimetres, and a - b in metres?");
}

TEST(UnitDoubt, OneThatIsNearTheOriginIsNoMixture) {
  EXPECT_EQ(UnitDoubt(PoseTable{Row("01", 0.0), Row("02", 0.01), Row("03", 900.0), Row("04", 1900.0)}),
            "1000 m between captures 03 and 04: are these millimetres?");
}

TEST(UnitDoubt, ManyRowsAreNotAllNamed) {
  PoseTable rows = {Row("00", 900.0)};
  for (int i = 11; i < 21; ++i) rows.push_back(Row(std::to_string(i), 1.0));
  EXPECT_EQ(
      UnitDoubt(rows),
      "899 m between captures 00 and 11: is capture 00 in millimetres, and captures 11, 12, 13, 14, 15 and 5 more "
      "in metres?");
}

TEST(UnitDoubt, IsARefusalBeyondAnyRobot) {
  EXPECT_TRUE(CheckSensorsApart(RigOf({SensorAt("top", {0, 60, 80})})));
  EXPECT_TRUE(CheckSensorsApart(RigOf({})));
  const Status refused = CheckSensorsApart(RigOf({SensorAt("top", {0, 60, 0}), SensorAt("back", {0, -60, 0})}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Sentence(refused.error()),
            "T_ref_nominal: 120 m between back and top: are these millimetres? Give p_m in metres.");
}

TEST(UnitDoubt, OfEdgesEachByItself) {
  EXPECT_EQ(UnitDoubt(std::vector<Edge>{EdgeAlong("a", "b", 40.0), EdgeAlong("b", "c", 40.0)}), "");
  EXPECT_EQ(UnitDoubt(std::vector<Edge>{EdgeAlong("a", "b", 83.2), EdgeAlong("front", "top", -210.4)}),
            "210 m between front and top: are these millimetres?");
  Edge failed = EdgeAlong("a", "b", 1e9);
  failed.state = EdgeState::kFailed;
  EXPECT_EQ(UnitDoubt(std::vector<Edge>{failed}), "");
}

TEST(UnitDoubt, OfATrackerByItsSteps) {
  EXPECT_EQ(UnitDoubt(PoseTable{Row("01", 5e5), Row("02", 5e5 + 99.0)}), "") << "far away is no doubt";
  EXPECT_EQ(UnitDoubt(PoseTable{Row("01", 0.0), Row("02", 150.0), Row("03", -160.0)}),
            "310 m between captures 02 and 03: are these millimetres?");
  EXPECT_EQ(UnitDoubt(PoseTable{Row("01", 0.0)}), "");
  EXPECT_EQ(UnitDoubt(PoseTable{}), "");
}

TEST(UnitDoubt, OfAnyNumberIsShort) {
  EXPECT_EQ(UnitDoubt(std::map<std::string, Vector3d>{{"a", Vector3d::Zero()}, {"b", {2e6, 0, 0}}}),
            "2e+06 m between a and b: are these millimetres?");
}

}  // namespace
}  // namespace rigcal

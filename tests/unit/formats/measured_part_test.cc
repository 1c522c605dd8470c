// How documents tell a pose of which directions were not measured.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/formats/answers/answers.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Of "up" the height was not measured, as the camera "left" has it: its axis y points down.
RevisionInput OpenRevision() {
  RevisionInput input = samples::SampleRevision();
  SensorPose& pose = input.solution.poses[2];
  pose.unobservable_basis = {Vector6d::Unit(tangent::kY)};
  pose.measured_part = MeasuredPart{};
  pose.measured_part->T_ref_sensor.p_m = {0.25, -0.5, 1.5};
  const Vector6d variance = (Vector6d() << 1e-6, 0, 9e-6, 4e-8, 1e-8, 16e-8).finished();
  pose.measured_part->covariance = variance.asDiagonal();
  input.solution.R_ref_robot = (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();
  return input;
}

json AxisNamed(const json& part, const std::string& name) {
  for (const json& axis : part.at("axes"))
    if (axis.at("name") == name) return axis;
  return {};
}

TEST(MeasuredPartDocument, TellsEachAxisOrThatItWasNotMeasured) {
  const json document = json::parse(WriteRevisionDocument(OpenRevision()));
  const json sensor = document["sensors"][2], part = sensor["measured_part"];
  EXPECT_EQ(sensor["known"], false);
  for (const char* key : {"T_ref_sensor", "covariance", "sigma_m", "sigma_rad"})
    EXPECT_TRUE(sensor.at(key).is_null()) << key;
  ASSERT_EQ(part["axes"].size(), 6u);
  EXPECT_EQ(AxisNamed(part, "forward"),
            json::parse(R"({"direction":[0,0,1],"name":"forward","position_m":1.5,"sigma_m":0.003})"));
  EXPECT_EQ(AxisNamed(part, "sideways"),
            json::parse(R"({"direction":[-1,0,0],"name":"sideways","position_m":-0.25,"sigma_m":0.001})"));
  EXPECT_EQ(AxisNamed(part, "height"),
            json::parse(R"({"direction":[0,-1,0],"name":"height","position_m":null,"sigma_m":null})"));
  EXPECT_NEAR(AxisNamed(part, "roll")["sigma_rad"].get<double>(), 4e-4, 1e-12);
  EXPECT_EQ(part["sigma_source"], "analytic");
  EXPECT_EQ(part["T_ref_sensor"]["p_m"][2], 1.5);
  EXPECT_EQ(document["robot_axes"], json::parse(R"({"forward":[0,0,1],"left":[-1,0,0],"up":[0,-1,0]})"));
}

TEST(MeasuredPartDocument, ComesBackWithTheSameBytes) {
  for (const bool whole : {false, true}) {
    const RevisionInput input = OpenRevision();
    const std::string text = whole ? WriteWholeRevisionDocument(input) : WriteRevisionDocument(input);
    const auto read = ReadRevisionDocument(text);
    ASSERT_TRUE(read) << Sentence(read.error());
    const SensorPose& pose = read->solution.poses[2];
    EXPECT_FALSE(pose.known);
    ASSERT_TRUE(pose.measured_part);
    EXPECT_EQ(pose.measured_part->T_ref_sensor, input.solution.poses[2].measured_part->T_ref_sensor);
    EXPECT_EQ(pose.measured_part->covariance, input.solution.poses[2].measured_part->covariance);
    EXPECT_FALSE(pose.measured_part->by_jackknife);
    EXPECT_EQ(read->solution.R_ref_robot, input.solution.R_ref_robot);
    EXPECT_EQ(whole ? WriteWholeRevisionDocument(*read) : WriteRevisionDocument(*read), text);
  }
}

TEST(MeasuredPartDocument, WithoutTheRobotsAxesItTellsThoseOfTheReference) {
  RevisionInput input = OpenRevision();
  input.solution.R_ref_robot.reset();
  const json document = json::parse(WriteRevisionDocument(input));
  EXPECT_FALSE(document.contains("robot_axes"));
  EXPECT_TRUE(AxisNamed(document["sensors"][2]["measured_part"], "y")["sigma_m"].is_null());
  EXPECT_EQ(AxisNamed(document["sensors"][2]["measured_part"], "z")["position_m"], 1.5);
  EXPECT_FALSE(ReadRevisionDocument(WriteRevisionDocument(input))->solution.R_ref_robot);
}

TEST(MeasuredPartDocument, IsAbsentWhereNothingIsKnownInPart) {
  const json document = json::parse(WriteRevisionDocument(samples::SampleRevision()));
  EXPECT_FALSE(document.contains("robot_axes"));
  for (const json& sensor : document["sensors"]) EXPECT_FALSE(sensor.contains("measured_part"));
}

std::string ErrorOf(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  const auto read = ReadRevisionDocument(text);
  return read ? "" : read.error().what;
}

TEST(MeasuredPartDocument, WhatIsWrongIsNamed) {
  const std::string text = WriteRevisionDocument(OpenRevision());
  EXPECT_THAT(ErrorOf(text, "\"up\":[0.0,-1.0,0.0]", "\"up\":[0.0,-2.0,0.0]"),
              HasSubstr("robot_axes: must be three unit vectors"));
  EXPECT_THAT(ErrorOf(text, "\"unobservable_basis\":[[0.0,1.0,0.0,0.0,0.0,0.0]]", "\"unobservable_basis\":[]"),
              HasSubstr("measured_part: needs unobservable_basis"));
}

LookupAnswer OpenLookup() {
  LookupAnswer answer;
  answer.robot = RobotId("mapper-01");
  answer.revision = 3;
  answer.frame_a = SensorId("left"), answer.frame_b = SensorId("up");
  answer.T_a_b.p_m = {0.1, 0.2, 0.3};
  answer.covariance = 1e-6 * Matrix6d::Identity();
  answer.covariance(2, 2) = 0.0;
  answer.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  return answer;
}

TEST(MeasuredPartDocument, ALookupThatIsOpenHasNoWholePose) {
  LookupAnswer answer = OpenLookup();
  answer.R_a_robot = Eigen::Matrix3d::Identity();
  const json document = json::parse(WriteLookup(answer));
  EXPECT_EQ(document["known"], false);
  for (const char* key : {"T_a_b", "covariance", "sigma_m", "sigma_rad"})
    EXPECT_TRUE(document.at(key).is_null()) << key;
  EXPECT_EQ(document["unobservable_basis"], json::parse("[[0,0,1,0,0,0]]"));
  EXPECT_EQ(document["measured_part"]["T_a_b"]["p_m"], json::parse("[0.1,0.2,0.3]"));
  EXPECT_TRUE(AxisNamed(document["measured_part"], "height")["sigma_m"].is_null());
  EXPECT_EQ(AxisNamed(document["measured_part"], "forward")["sigma_m"], 1e-3);
  EXPECT_TRUE(document.contains("robot_axes"));
  answer.R_a_robot.reset();
  EXPECT_EQ(json::parse(WriteLookup(answer))["measured_part"]["axes"][0]["name"], "x");
  EXPECT_FALSE(json::parse(WriteLookup(answer)).contains("robot_axes"));
}

TEST(MeasuredPartDocument, ALookupThatIsWholeSaysSo) {
  LookupAnswer answer = OpenLookup();
  answer.unobservable_basis.clear();
  const json document = json::parse(WriteLookup(answer));
  EXPECT_EQ(document["known"], true);
  EXPECT_FALSE(document.contains("measured_part"));
  EXPECT_EQ(document["T_a_b"]["p_m"][1], 0.2);
}

}  // namespace
}  // namespace rigcal::formats

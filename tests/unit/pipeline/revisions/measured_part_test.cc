// A robot of which the height of some sensors was not measured: what is told of it, from edges to answers.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/formats/documents.h"
#include "server/pipeline/answers/answer.h"
#include "storage/revisions/revisions.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class MeasuredPartTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  Result<std::string> Ask(const std::string& verb, const std::string& parameters) {
    return Answer({*store_, clock_, revisions_cache_, clock_.now, "http://127.0.0.1:1"}, verb, parameters);
  }
  json Lookup(const std::string& a, const std::string& b) {
    const auto answer = Ask("lookup", R"({"robot":"r","a":")" + a + R"(","b":")" + b + "\"}");
    if (!answer) ADD_FAILURE() << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  json Sensor(const std::string& id) {
    const json shown = json::parse(Ask("show", R"({"robot":"r"})").value_or("{}"));
    for (const json& sensor : shown.at("document").at("sensors"))
      if (sensor["id"] == id) return sensor;
    return {};
  }
};

// base and front are known to each other; the height of lidar is not, and rear is fixed to lidar.
std::vector<Edge> LevelFloor() {
  std::vector<Edge> edges = {GivenEdge("r", "base", "front", 1.0), GivenEdge("r", "base", "lidar", 2.0),
                             GivenEdge("r", "lidar", "rear", 0.5)};
  edges[1].T_a_b.p_m.z() = 0.7;  // as the drawing has it
  Matrix6d Omega = edges[1].uncertainty.Omega;
  Omega(tangent::kZ, tangent::kZ) = 0.0;
  edges[1].uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
  AssignPushedIds(edges);
  return edges;
}

std::vector<std::string> NotMeasured(const json& part) {
  std::vector<std::string> names;
  for (const json& axis : part["axes"])
    if (axis.contains("sigma_rad") ? axis["sigma_rad"].is_null() : axis["sigma_m"].is_null())
      names.push_back(axis["name"]);
  return names;
}

TEST_F(MeasuredPartTest, TheDocumentTellsEachAxisOfTheSensor) {
  StoreEdges(LevelFloor());
  StepAll();
  ASSERT_EQ(revisions_.size(), 1u);
  EXPECT_EQ(revisions_[0].verdict.why,
            "The position along z of lidar and rear in the frame of base was not measured; the rest was, to 1.5 mm and "
            "0.081 deg.");
  const json lidar = Sensor("lidar"), part = lidar["measured_part"];
  EXPECT_EQ(lidar["known"], false);
  EXPECT_TRUE(lidar["T_ref_sensor"].is_null() && lidar["sigma_m"].is_null());
  EXPECT_THAT(NotMeasured(part), testing::ElementsAre("z"));
  EXPECT_NEAR(part["axes"][0]["position_m"].get<double>(), 2.0, 1e-9);
  EXPECT_NEAR(part["axes"][0]["sigma_m"].get<double>(), 1e-3, 1e-9);
  EXPECT_TRUE(part["axes"][2]["position_m"].is_null());
  EXPECT_NEAR(part["T_ref_sensor"]["p_m"][2].get<double>(), 0.7, 1e-9);
  EXPECT_EQ(part["sigma_source"], "analytic");
  EXPECT_THAT(NotMeasured(Sensor("rear")["measured_part"]), testing::ElementsAre("z"));
  EXPECT_FALSE(Sensor("front").contains("measured_part"));
}

// Odometry tells which way the robot looks: so a height is called that.
TEST_F(MeasuredPartTest, ABodyThatASessionHasNamesTheAxes) {
  Manifest manifest;
  manifest.header.robot = RobotId("r");
  manifest.header.reference = SensorId("base");
  manifest.header.captured_at = clock_.now;
  for (const auto& [name, kind] :
       {std::pair("base", SensorKind::kPoseStream), std::pair("lidar", SensorKind::kLidar)}) {
    rigcal::Sensor& sensor = manifest.header.sensors.emplace_back();
    sensor.id = SensorId(name);
    sensor.kind = kind;
  }
  AddFile("lidar/1.pcd", "points", manifest);
  std::vector<Edge> edges = LevelFloor();
  edges[1].session = Close(manifest);
  edges[1].id = EstimatedEdgeId(edges[1].robot, edges[1].session, edges[1].method, edges[1].frame_a, edges[1].frame_b);
  StoreEdges(edges);
  StepAll();
  EXPECT_THAT(revisions_.back().verdict.why, testing::StartsWith("The height of lidar and rear was not measured"));
  EXPECT_THAT(NotMeasured(Sensor("lidar")["measured_part"]), testing::ElementsAre("height"));
  EXPECT_THAT(NotMeasured(Lookup("front", "rear")["measured_part"]), testing::ElementsAre("height"));
  EXPECT_TRUE(Lookup("front", "rear").contains("robot_axes"));
}

TEST_F(MeasuredPartTest, ALookupWithAnOpenDirectionIsNoWholeAnswer) {
  StoreEdges(LevelFloor());
  StepAll();
  const json open = Lookup("front", "rear");
  EXPECT_EQ(open["known"], false);
  for (const char* key : {"T_a_b", "covariance", "sigma_m", "sigma_rad"}) EXPECT_TRUE(open.at(key).is_null()) << key;
  ASSERT_EQ(open["unobservable_basis"].size(), 1u);
  EXPECT_NEAR(open["unobservable_basis"][0][2].get<double>(), 1.0, 1e-9);
  const json part = open["measured_part"];
  EXPECT_THAT(NotMeasured(part), testing::ElementsAre("z"));
  EXPECT_NEAR(part["axes"][0]["position_m"].get<double>(), 1.5, 1e-9);
  // Three edges, and how front is pitched over the 0.7 m up to rear.
  EXPECT_NEAR(part["axes"][0]["sigma_m"].get<double>(), std::sqrt(3e-6 + 0.49e-6), 1e-9);
  EXPECT_NEAR(part["covariance"][2][2].get<double>(), 0.0, 1e-18);
}

TEST_F(MeasuredPartTest, SensorsThatAreFixedToEachOtherHaveAWholeAnswer) {
  StoreEdges(LevelFloor());
  StepAll();
  for (const auto& [a, b, x_m] : {std::tuple("lidar", "rear", 0.5), std::tuple("base", "front", 1.0)}) {
    const json answer = Lookup(a, b);
    EXPECT_EQ(answer["known"], true) << a;
    EXPECT_NEAR(answer["T_a_b"]["p_m"][0].get<double>(), x_m, 1e-9);
    EXPECT_NEAR(answer["sigma_m"][2].get<double>(), 1e-3, 1e-8);
    EXPECT_FALSE(answer.contains("measured_part"));
  }
}

TEST_F(MeasuredPartTest, BlocksMakeTheSigmasThoseOfTheJackknife) {
  std::vector<Edge> edges = LevelFloor();
  for (Edge& edge : edges) {
    edge.uncertainty.source = UncertaintySource::kJackknife;
    edge.uncertainty.dof = 11;
    for (int axis = 0; axis < 6; ++axis)
      for (const double sign : {1.0, -1.0}) {
        const double size =
            edge.uncertainty.rank < 6 && axis == tangent::kZ ? 0.0 : sign * 2e-3 * std::sqrt(12.0 / 22.0);
        edge.uncertainty.blocks.push_back(
            {std::to_string(axis) + (sign > 0.0 ? "+" : "-"), size * Vector6d::Unit(axis)});
      }
  }
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  const json part = Sensor("lidar")["measured_part"];
  EXPECT_EQ(part["sigma_source"], "jackknife");
  EXPECT_NEAR(part["axes"][0]["sigma_m"].get<double>(), 2e-3, 1e-8);
  EXPECT_NEAR(Lookup("base", "lidar")["measured_part"]["axes"][0]["sigma_m"].get<double>(), 2e-3, 1e-8);
}

// A revision that an older version made knows nothing of the part: the reason is told, as it was.
TEST_F(MeasuredPartTest, ADocumentFromBeforeStillSaysWhy) {
  StoreEdges(LevelFloor());
  StepAll();
  Revision revision = storage::LoadRevision(*store_, RobotId("r"), 0).value().value();
  auto input = formats::ReadRevisionDocument(revision.document).value();
  for (SensorPose& pose : input.solution.poses) pose.measured_part.reset();
  revision.document = formats::WriteRevisionDocument(input);
  revision.digest = Sha256Of(revision.document);
  EXPECT_EQ(revision.document.find("robot_axes"), std::string::npos);
  ASSERT_TRUE(store_->Write([&]() -> Status {
    RIGCAL_ASSIGN(revision.number, storage::AppendRevision(*store_, revision));
    return {};
  }));
  const auto answer = Ask("lookup", R"({"robot":"r","a":"base","b":"lidar","revision":2})");
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().what,
              HasSubstr("sensor lidar is not fully determined: its edges leave free translation along z"));
}

}  // namespace
}  // namespace rigcal::pipeline

// Rig models, epochs and populations from the order to what is told, with a store and the pipeline itself.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kMars = R"(rig_model: mars
tolerance_mm: 10
tolerance_deg: 1
sensors:
  a: {type: pose_stream}
  b: {type: pose_stream, T_ref_sensor: {p_m: [1.0, 0.0, 0.0]}}
  c: {type: pose_stream, T_ref_sensor: {p_m: [2.003, 0.0, 0.0]}}
)";

class RigModelOrders : public PipelineTest {
 protected:
  Result<OrderDone> Order(const std::string& verb, json parameters) {
    for (const char* word : {"who", "reason"})
      if (!parameters.contains(word)) parameters[word] = std::string("of the ") + word;
    return CarryOut(*store_, clock_, verb, parameters.dump());
  }
  json Done(const std::string& verb, const json& parameters) {
    const auto done = Order(verb, parameters);
    EXPECT_TRUE(done) << Sentence(done.error());
    return done ? json::parse(done->document) : json();
  }
  json Ask(const std::string& verb, const json& parameters) {
    RevisionCache revisions;
    const auto answer = Answer({*store_, clock_, revisions, {}, ""}, verb, parameters.dump());
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  std::string Page(const std::string& path) {
    RevisionCache revisions;
    const auto page = AnswerPage({*store_, clock_, revisions, {}, ""}, path, "");
    return page ? page->body : Sentence(page.error());
  }
  // A session without a pair to calibrate: it names the rig model, and lists a pose stream.
  void Name(const std::string& robot, const std::string& model, const std::string& serial = "") {
    Manifest manifest;
    manifest.header.robot = RobotId(robot);
    manifest.header.rig_model = model;
    manifest.header.captured_at = clock_.now;
    manifest.header.reference = SensorId("a");
    Sensor sensor;
    sensor.id = SensorId("a");
    sensor.kind = SensorKind::kPoseStream;
    sensor.serial = serial;
    manifest.header.sensors = {sensor};
    AddFile("a/poses.csv", robot + model + serial + ToIso(clock_.now), manifest);
    Close(manifest);
  }
  void PushTriangleOf(const std::string& robot) { StoreEdges(Triangle(robot)); }
  [[nodiscard]] std::string Why() const { return revisions_.back().verdict.why; }
};

TEST_F(RigModelOrders, SettingOneJudgesItsRobotsAnew) {
  Name("r", "mars");
  PushTriangleOf("r");
  StepAll();
  ASSERT_FALSE(revisions_.empty());
  const std::size_t before = revisions_.size();
  EXPECT_THAT(Why(), Not(HasSubstr("rig model")));
  const json done = Done("set_rig_model", {{"text", std::string(kMars) + "  imu_front: {type: camera}\n"}});
  EXPECT_EQ(done["set"]["version"], 1);
  EXPECT_EQ(done["robots_waiting"], 1);
  EXPECT_EQ(Ask("status", {{"robot", "r"}})["robots"][0]["calculating"], true);
  StepAll();
  ASSERT_EQ(revisions_.size(), before + 1);
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(Why(), HasSubstr("imu_front is in rig model mars but not here"));
  const json document = json::parse(revisions_.back().document);
  EXPECT_EQ(document["policy"]["rig_model"], "mars");
  EXPECT_EQ(document["policy"]["rig_model_version"], 1);
  EXPECT_EQ(document["causes"][0]["kind"], "sensor_missing");
  EXPECT_EQ(Ask("status", {{"robot", "r"}})["robots"][0]["calculating"], false);
  EXPECT_EQ(StepAll(), 0);
}

TEST_F(RigModelOrders, ASessionSaysWhatItLacks) {
  Name("r", "mars");
  const std::string id = Ask("sessions", {{"robot", "r"}})["sessions"][0]["session"];
  EXPECT_FALSE(Ask("session", {{"id", id}}).contains("lacking"));
  Done("set_rig_model", {{"text", kMars}});
  EXPECT_EQ(Ask("session", {{"id", id}})["lacking"], "b and c are in rig model mars but not here.");
  EXPECT_THAT(Page("/robots/r/sessions/" + id + "/"), HasSubstr("b and c are in rig model mars but not here."));
}

TEST_F(RigModelOrders, AnotherModelJudgesNobody) {
  Name("r", "mars");
  PushTriangleOf("r");
  StepAll();
  EXPECT_EQ(Done("set_rig_model",
                 {{"text", "rig_model: moon\nsensors: {x: {type: camera}}\n"}, {"new_model", true}})["robots_waiting"],
            0);
  EXPECT_EQ(StepAll(), 0);
}

// Its row in the queue must go though the model that was set is its own no more.
TEST_F(RigModelOrders, ARobotThatChangedItsModelIsJudgedOnce) {
  Name("r", "mars");
  PushTriangleOf("r");
  clock_.now.ns += 1'000'000'000;
  Name("r", "moon");
  StepAll();
  EXPECT_EQ(Done("set_rig_model", {{"text", kMars}})["robots_waiting"], 1) << "it was of it once";
  StepAll();
  EXPECT_EQ(StepAll(), 0);
  EXPECT_THAT(Why(), Not(HasSubstr("mars")));
}

TEST_F(RigModelOrders, AMisspeltModelIsRefused) {
  Name("r", "mars");
  const auto refused = Order("set_rig_model", {{"text", "rig_model: marz\nsensors: {a: {type: camera}}\n"}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(Order("set_rig_model", {{"text", "rig_model: mars\n"}})) << "without sensors";
  EXPECT_FALSE(Order("set_rig_model", {{"text", kMars}, {"reason", ""}}));
  EXPECT_TRUE(IsOrder("set_rig_model") && IsOrder("epoch"));
  EXPECT_FALSE(IsOrder("rig_model") || IsOrder("population"));
}

TEST_F(RigModelOrders, WhatHoldsIsToldAndListed) {
  Name("r", "mars");
  Name("s", "moon");
  Done("set_rig_model", {{"text", kMars}});
  const json told = Ask("rig_model", {{"model", "mars"}});
  EXPECT_EQ(told["set"]["text"], kMars);
  EXPECT_EQ(told["robots"], 1);
  const json list = Ask("rig_models", json::object())["rig_models"];
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0], (json{{"rig_model", "mars"}, {"version", 1}, {"robots", 1}}));
  EXPECT_TRUE(list[1]["version"].is_null());
  EXPECT_THAT(Page("/models/"), HasSubstr("href=\"mars/\""));
}

TEST_F(RigModelOrders, AnEpochMakesWhatWasMeasuredOfASensorPast) {
  PushTriangleOf("r");
  StepAll();
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kPass) << Why();
  clock_.now.ns += 5'000'000'000;
  const json done = Done("epoch", {{"robot", "r"}, {"sensors", "c"}, {"who", "Ada"}, {"reason", "new bracket"}});
  EXPECT_EQ(done["sensors"], (json{"c"}));
  EXPECT_EQ(done["revision_follows"], true);
  StepAll();
  const json document = json::parse(revisions_.back().document);
  int past = 0;
  for (const json& edge : document["edges"])
    if (edge["state"] == "failed") {
      ++past;
      EXPECT_EQ(edge["diagnoses"][0]["code"], "epoch");
      EXPECT_THAT(edge["diagnoses"][0]["what"].get<std::string>(),
                  HasSubstr("an epoch of c was begun by Ada: new bracket"));
    }
  EXPECT_EQ(past, 2) << "b - c and a - c; a - b stays";
  EXPECT_EQ(InUse(), 0) << "what was in use knows the sensor elsewhere";
  const json epochs = Ask("revisions", {{"robot", "r"}})["epochs"];
  ASSERT_EQ(epochs.size(), 1U);
  EXPECT_EQ(epochs[0]["cause"], "person");
  EXPECT_EQ(epochs[0]["reason"], "new bracket");
  EXPECT_THAT(Page("/robots/r/"), HasSubstr("an epoch of c was begun by Ada: new bracket"));
  clock_.now.ns += 5'000'000'000;
  StoreEdges([] {
    std::vector<Edge> edges = {GivenEdge("r", "b", "c", 1.1), GivenEdge("r", "a", "c", 2.103)};
    AssignPushedIds(edges);
    return edges;
  }());
  StepAll();
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kPass) << Why();
}

TEST_F(RigModelOrders, AnEpochIsSaidOnceAndTakenBack) {
  PushTriangleOf("r");
  StepAll();
  clock_.now.ns += 5'000'000'000;
  const json first = Done("epoch", {{"robot", "r"}}), again = Done("epoch", {{"robot", "r"}});
  EXPECT_EQ(first["sensors"], (json{"a", "b", "c"}));
  EXPECT_EQ(first["standing"]["number"], again["standing"]["number"]);
  StepAll();
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kUnknown) << "nothing is left";
  EXPECT_EQ(Done("epoch", {{"robot", "r"}, {"take_back", true}})["taken_back"], true);
  StepAll();
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kPass) << Why();
  EXPECT_EQ(Order("epoch", {{"robot", "r"}, {"take_back", true}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Order("epoch", {{"robot", "r"}, {"sensors", "rigth"}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Order("epoch", {{"robot", "nobody"}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Order("epoch", {{"robot", "r"}, {"at", "2100-01-01"}}).error().code, ErrorCode::kInvalidInput);
}

TEST_F(RigModelOrders, AnExchangedPartIsToldByItsSession) {
  Name("r", "mars", "A1");
  clock_.now.ns += 1'000'000'000;
  Name("r", "mars", "B7");
  const json epochs = Ask("revisions", {{"robot", "r"}})["epochs"];
  ASSERT_EQ(epochs.size(), 1U);
  EXPECT_EQ(epochs[0]["text"], "the serial number of a is B7, before it was A1");
  EXPECT_EQ(epochs[0]["cause"], "serial");
  EXPECT_THAT(Page("/robots/r/"), HasSubstr("the serial number of a is B7, before it was A1"));
}

// One of seven robots has c where no other has it.
TEST_F(RigModelOrders, APopulationIsOfTheCalibrationsInUse) {
  for (int i = 0; i < 7; ++i) {
    const std::string robot = "r" + std::to_string(i);
    Name(robot, "mars");
    const double c_m = i == 6 ? 2.3 : 2.003 + 1e-4 * i;
    std::vector<Edge> edges = {GivenEdge(robot, "a", "b", 1.0), GivenEdge(robot, "b", "c", c_m - 1.0),
                               GivenEdge(robot, "a", "c", c_m)};
    AssignPushedIds(edges);
    StoreEdges(edges);
  }
  Name("idle", "mars");
  StepAll();
  Done("set_rig_model", {{"text", kMars}});
  StepAll();
  const json told = Ask("population", {{"model", "mars"}});
  EXPECT_TRUE(told["why_not"].is_null()) << told.dump();
  EXPECT_EQ(told["robots"], 7);
  EXPECT_EQ(told["reference"], "a");
  ASSERT_EQ(told["sensors"].size(), 2U);
  const json c = told["sensors"][1];
  EXPECT_EQ(c["id"], "c");
  EXPECT_NEAR(c["axes"][0]["median_m"].get<double>(), 3e-4, 1e-4);
  EXPECT_NEAR(c["axes"][0]["max_m"].get<double>(), 0.297, 1e-3);
  EXPECT_NEAR(c["axes"][1]["max_m"].get<double>(), 0.0, 1e-9);
  ASSERT_EQ(c["outliers"].size(), 1U) << c.dump();
  EXPECT_EQ(c["outliers"][0]["robot"], "r6");
  EXPECT_EQ(told["left_out"][0]["robot"], "idle");
  const std::string page = Page("/models/mars/");
  EXPECT_THAT(page, HasSubstr("Robots that stand out"));
  EXPECT_THAT(page, HasSubstr("href=\"../../robots/r6/\""));
  EXPECT_THAT(page, HasSubstr("class=\"dots out\""));
  EXPECT_THAT(Page("/models/marz/"), HasSubstr("marz"));

  // What was measured of it before is past: no calibration of it is in use any more.
  clock_.now.ns += 1'000'000'000;
  Done("epoch", {{"robot", "r6"}});
  StepAll();
  const json without = Ask("population", {{"model", "mars"}});
  EXPECT_EQ(without["robots"], 6);
  EXPECT_THAT(without["left_out"], Contains(json({{"robot", "r6"}, {"why", "no calibration of it is in use"}})));
  EXPECT_TRUE(without["sensors"][1]["outliers"].empty()) << without.dump();
}

}  // namespace
}  // namespace rigcal::pipeline

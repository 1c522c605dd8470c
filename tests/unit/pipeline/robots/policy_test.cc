// The limits that people set: from the order to a new verdict, robot by robot, behind all other work.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/robots/policies.h"
#include "storage/revisions/revisions.h"
#include "storage/settings/policies.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class PolicyTest : public PipelineTest {
 protected:
  Result<OrderDone> Order(json parameters) {
    if (!parameters.contains("who")) parameters["who"] = "Ada";
    if (!parameters.contains("reason")) parameters["reason"] = "new mounts";
    return CarryOut(*store_, clock_, "set_policy", parameters.dump());
  }
  json Set(const json& parameters) {
    const auto done = Order(parameters);
    EXPECT_TRUE(done) << Sentence(done.error());
    return done ? json::parse(done->document) : json();
  }
  json Ask(const std::string& verb, const json& parameters) {
    RevisionCache revisions;
    const auto answer = Answer({*store_, clock_, revisions, {}, ""}, verb, parameters.dump());
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  void PushTriangle(const std::string& robot) { StoreEdges(Triangle(robot)); }
  json Judged() { return json::parse(revisions_.back().document)["policy"]; }
};

TEST_F(PolicyTest, OneOfARobotJudgesItAnew) {
  PushTriangle("r");
  StepAll();
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kPass) << revisions_.back().verdict.why;
  EXPECT_EQ(Judged()["versions"], (json{{"fleet", 0}, {"model", 0}, {"robot", 0}}));
  const json done = Set({{"robot", "r"}, {"text", "tolerance_mm: 0.1\n"}});
  EXPECT_EQ(done["set"]["version"], 1);
  EXPECT_EQ(done["robots_waiting"], 1);
  EXPECT_EQ(done["revision_follows"], true);
  EXPECT_EQ(Ask("status", {{"robot", "r"}})["robots"][0]["calculating"], true);
  EXPECT_EQ(StepAll(), 2);  // revise, publish
  ASSERT_EQ(revisions_.size(), 2U);
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(revisions_.back().verdict.why, HasSubstr("(0.1 mm and 0.29 deg wanted)"));
  EXPECT_EQ(Judged()["versions"]["robot"], 1);
  EXPECT_EQ(json::parse(revisions_.back().document)["sensors"][1]["tolerance_m"], 0.0001);
  EXPECT_EQ(Ask("status", {{"robot", "r"}})["robots"][0]["calculating"], false);
  EXPECT_EQ(Set({{"robot", "r"}, {"text", "tolerance_mm: 0.1\n"}})["set"]["version"], 1);
  EXPECT_EQ(StepAll(), 0) << "it was set before";
}

// Each of both is known to about 1 mm, to the reference and to the other.
TEST_F(PolicyTest, AToleranceOfAPairBoundsHowWellItIsKnown) {
  PushTriangle("r");
  StepAll();
  Set({{"robot", "r"}, {"text", "pairs:\n  b - c: {tolerance_mm: 0.1}\n"}});
  StepAll();
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(revisions_.back().verdict.why, HasSubstr("b - c is known to "));
  EXPECT_THAT(revisions_.back().verdict.why, HasSubstr("only (0.1 mm and 0.29 deg wanted)"));
  Set({{"robot", "r"}, {"text", "pairs:\n  b - c: {tolerance_mm: 4}\n"}});
  StepAll();
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kPass) << revisions_.back().verdict.why;
}

TEST_F(PolicyTest, OneOfTheFleetComesBehindWhatIsNew) {
  for (const char* robot : {"a", "b"}) PushTriangle(robot);
  StepAll();
  EXPECT_EQ(Set({{"text", "max_age_days: 10\n"}})["robots_waiting"], 2);
  PushTriangle("z");
  ASSERT_TRUE(StepOnce()->worked);
  EXPECT_EQ(revisions_.back().robot, RobotId("z")) << "its edges are new";
  const std::size_t before = revisions_.size();
  StepAll();
  ASSERT_EQ(revisions_.size(), before + 2);
  for (const std::size_t back : {1U, 2U}) {
    const Revision& revision = revisions_[revisions_.size() - back];
    EXPECT_NE(revision.robot, RobotId("z"));
    EXPECT_EQ(revision.max_age_ns, 10LL * 86'400'000'000'000);
  }
}

TEST_F(PolicyTest, TheNarrowerOneHoldsKeyByKey) {
  PushTriangle("r");
  StepAll();
  Set({{"text", "tolerance_mm: 4\nmax_age_days: 10\n"}});
  Set({{"robot", "r"}, {"text", "tolerance_mm: 3\n"}, {"who", "Bob"}});
  const json told = Ask("policy", {{"robot", "r"}});
  EXPECT_EQ(told["limits"]["tolerance_m"], 0.003);
  EXPECT_EQ(told["limits"]["max_age_ns"], 10LL * 86'400'000'000'000);
  ASSERT_EQ(told["set"].size(), 2U);
  EXPECT_EQ(told["set"][0]["scope"], "fleet");
  EXPECT_EQ(told["set"][1]["who"], "Bob");
  EXPECT_EQ(told["set"][1]["text"], "tolerance_mm: 3\n");
  EXPECT_EQ(Ask("policy", json::object())["limits"]["tolerance_m"], 0.004);
}

TEST_F(PolicyTest, OneOfARigModelIsForItsRobots) {
  Manifest manifest;
  manifest.header.robot = RobotId("m");
  manifest.header.rig_model = "mars mapper";
  manifest.header.captured_at = clock_.now;
  manifest.header.reference = SensorId("left");
  Target board;
  board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = 0.025;
  manifest.header.targets = {board};
  for (const char* name : {"left", "right"}) manifest.header.sensors.emplace_back().id = SensorId(name);
  AddFile("left/01.png", "no picture", manifest);
  AddFile("right/01.png", "nor this", manifest);
  Close(manifest);
  PushTriangle("other");
  StepAll();
  EXPECT_EQ(Set({{"model", "mars mapper"}, {"text", "max_age_days: 20\n"}})["robots_waiting"], 1);
  StepAll();
  EXPECT_EQ(revisions_.back().robot, RobotId("m"));
  EXPECT_EQ(revisions_.back().max_age_ns, 20LL * 86'400'000'000'000);
  EXPECT_EQ(Judged()["rig_model"], "mars mapper");
  EXPECT_EQ(Ask("policy", {{"model", "mars mapper"}})["set"].size(), 1U);
  EXPECT_EQ(Ask("policy", {{"model", "another"}})["set"].size(), 0U);
}

TEST_F(PolicyTest, WhenARobotIsDueIsItsPolicysWord) {
  PushTriangle("r");
  StepAll();
  const Stamp calibrated = clock_.now;
  Set({{"robot", "r"}, {"text", "max_age_days: 10\n"}});
  StepAll();
  clock_.now.ns = calibrated.ns + 10LL * 86'400'000'000'000;
  EXPECT_EQ(Ask("show", {{"robot", "r"}})["valid_until"], ToIso(clock_.now));
  EXPECT_EQ(Ask("show", {{"robot", "r"}})["overdue"], false);
  EXPECT_EQ(Ask("due", json::object())["robots"][0]["overdue"], false);
  clock_.now.ns += 1;
  EXPECT_EQ(Ask("show", {{"robot", "r"}})["overdue"], true);
  EXPECT_EQ(Ask("due", json::object())["robots"][0]["overdue"], true);
  EXPECT_TRUE(Ask("due", json::object())["max_age_ns"].is_null());
  EXPECT_EQ(Ask("due", {{"max_age_ns", kDefaultMaxAge_ns}})["robots"][0]["overdue"], false);
}

TEST_F(PolicyTest, ACrashBetweenOrderAndVerdictLosesNothing) {
  PushTriangle("r");
  StepAll();
  Set({{"text", "tolerance_mm: 0.1\n"}});
  store_.reset();
  store_ = std::make_unique<storage::Store>(std::move(*storage::Store::Open(folder_)));
  LiveGraphs live;
  RobotLocks claims;
  const auto step = Step({*store_, clock_, live, claims, announcer_, cameras_});
  ASSERT_TRUE(step && step->worked);
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kUnknown);
}

TEST_F(PolicyTest, PixelsAreHeldAgainstTheNewestIntrinsicsWhateverTheNameOfTheSession) {
  const auto header_of = [](double fx_px) {
    SessionHeader header;
    header.sensors.emplace_back().id = SensorId("left");
    header.sensors.back().intrinsics = CameraIntrinsics{};
    header.sensors.back().intrinsics->fx_px = fx_px;
    return header;
  };
  const SessionId first(std::string(64, '1')), second(std::string(64, '2')), untold(std::string(64, '0'));
  const std::map<SessionId, SessionHeader> headers = {
      {first, header_of(500.0)}, {second, header_of(800.0)}, {untold, header_of(300.0)}};
  for (const auto& [newest, fx_px] : {std::pair{first, 500.0}, std::pair{second, 800.0}}) {
    Policy policy;
    policy.all.tolerance_px_at_10_m = 1.0;
    std::map<SessionId, Stamp> captured_at = {{first, Stamp{10}}, {second, Stamp{10}}};
    captured_at[newest].ns = 20;
    ASSERT_TRUE(TakeFocals(*store_, {}, headers, captured_at, policy));
    EXPECT_EQ(policy.focal_px, (std::map<SensorId, double>{{SensorId("left"), fx_px}}));
  }
}

// It was taken when limits had no least value.
TEST_F(PolicyTest, AStoredLimitThatIsTooSmallHoldsUpNobody) {
  PushTriangle("r");
  StepAll();
  const Word word{clock_.now, "Ada", "a slip"};
  ASSERT_TRUE(store_->Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendPolicy(*store_, {}, "max_age_days: 1e-15\ntolerance_mm: 1e-322\n", word));
    return {};
  }));
  StepAll();
  ASSERT_EQ(revisions_.size(), 2U);
  const auto read = formats::ReadRevisionDocument(revisions_.back().document);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(revisions_.back().max_age_ns, 3'600'000'000'000);
  EXPECT_DOUBLE_EQ(Ask("policy", json::object())["limits"]["tolerance_m"].get<double>(), 1e-6);
  EXPECT_THAT(Order({{"text", "max_age_days: 1e-15\n"}}).error().what,
              HasSubstr("the policy of the fleet line 1: max_age_days: must be from 0.0416667 (1 h) to 36500"));
}

TEST_F(PolicyTest, PixelsAreHeldAgainstGivenIntrinsics) {
  Policy policy;
  policy.all.tolerance_px_at_10_m = 1.0;
  SessionHeader header;
  header.sensors.emplace_back().id = SensorId("left");
  header.sensors.back().intrinsics = CameraIntrinsics{};
  header.sensors.back().intrinsics->fx_px = 500.0;
  ASSERT_TRUE(TakeFocals(*store_, {}, {{SessionId(std::string(64, '1')), header}}, {}, policy));
  EXPECT_EQ(policy.focal_px, (std::map<SensorId, double>{{SensorId("left"), 500.0}}));
  Policy without;
  ASSERT_TRUE(TakeFocals(*store_, {}, {{SessionId(std::string(64, '1')), header}}, {}, without));
  EXPECT_TRUE(without.focal_px.empty()) << "nobody asks";
}

TEST_F(PolicyTest, ASensorThatTheRobotDoesNotHaveIsRefused) {
  std::vector<Edge> edges = {GivenEdge("r", "left", "right", 1.0), GivenEdge("r", "left", "top", 2.0)};
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  const auto refused = [&](const std::string& text) {
    const auto done = Order({{"robot", "r"}, {"text", text}});
    EXPECT_FALSE(done) << text;
    return done ? "" : Sentence(done.error());
  };
  const std::string cure = " `rigcal show r` lists its sensors.";
  EXPECT_EQ(refused("sensors: {rigth: {tolerance_mm: 2}}"),
            "robot 'r' has no sensor 'rigth': did you mean right?" + cure);
  EXPECT_EQ(refused("pairs: {left - lidar: {tolerance_mm: 2}}"), "robot 'r' has no sensor 'lidar'." + cure);
  EXPECT_EQ(storage::LoadPolicyWatermark(*store_).value(), 0);
  Set({{"robot", "r"}, {"text", "sensors: {right: {tolerance_mm: 2}}\npairs: {left - top: {tolerance_mm: 2}}\n"}});
  Set({{"text", "sensors: {rigth: {tolerance_mm: 2}}\n"}});  // another robot of the fleet may have it
}

TEST_F(PolicyTest, ARigModelThatNoSessionNamesIsRefusedUnlessItIsNew) {
  Manifest manifest;
  manifest.header.robot = RobotId("m");
  manifest.header.rig_model = "mars mapper";
  manifest.header.reference = SensorId("left");
  manifest.header.sensors.emplace_back().id = SensorId("left");
  AddFile("left/01.png", "no picture", manifest);
  Close(manifest);
  const auto done = Order({{"model", "mars maper"}, {"text", "max_age_days: 20\n"}});
  ASSERT_FALSE(done);
  EXPECT_EQ(Sentence(done.error()),
            "no session is of rig model \"mars maper\": did you mean mars mapper? Correct the name, or say with "
            "--new-model that its sessions are to come.");
  EXPECT_EQ(Set({{"model", "mars mapper"}, {"text", "max_age_days: 20\n"}})["set"]["version"], 1);
  EXPECT_EQ(Set({{"model", "venus"}, {"new_model", true}, {"text", "max_age_days: 20\n"}})["set"]["subject"], "venus");
}

TEST_F(PolicyTest, WhatCannotBeSetSaysWhy) {
  PushTriangle("r");
  StepAll();
  const auto refused = [&](const json& parameters) {
    const auto done = Order(parameters);
    EXPECT_FALSE(done);
    return done ? Error{} : done.error();
  };
  EXPECT_EQ(refused({{"robot", "r"}, {"text", "\ntolerance_m: 0.005"}}).what,
            "the policy of robot r line 2: tolerance_m: unknown key \"tolerance_m\"; write tolerance_mm: 5");
  EXPECT_EQ(refused({{"robot", "nobody"}, {"text", ""}}).code, ErrorCode::kNotFound);
  EXPECT_EQ(refused({{"robot", "r"}, {"model", "mars"}, {"text", ""}}).code, ErrorCode::kInvalidInput);
  EXPECT_EQ(refused({{"model", ""}, {"text", ""}}).code, ErrorCode::kInvalidInput);
  EXPECT_THAT(refused({{"text", ""}, {"reason", " "}}).what, HasSubstr("'reason' is missing"));
  EXPECT_EQ(storage::LoadPolicyWatermark(*store_).value(), 0);
  EXPECT_EQ(StepAll(), 0);
  EXPECT_TRUE(IsOrder("set_policy"));
  EXPECT_FALSE(IsOrder("policy"));
}

}  // namespace
}  // namespace rigcal::pipeline

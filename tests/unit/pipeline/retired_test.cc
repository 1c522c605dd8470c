// A sensor that is gone from its robot: from the order to the revision, the live graph, the pages, and back.
#include "storage/sessions/retired.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/model/edges/past.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "storage/revisions/revisions.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const RobotId kRobot("r");
const SensorId kMast("mast");

class RetiredSensorTest : public PipelineTest {
 protected:
  AnswerContext Context() { return {*store_, clock_, cache_, {}, ""}; }
  Result<OrderDone> Order(const std::string& verb, const std::string& thing, const std::string& robot = "r") {
    return CarryOut(*store_, clock_, verb,
                    json({{"thing", thing}, {"robot", robot}, {"who", "Ada"}, {"reason", "taken off"}}).dump());
  }
  void MustOrder(const std::string& verb, const std::string& thing) {
    const auto done = Order(verb, thing);
    ASSERT_TRUE(done) << Sentence(done.error());
    StepAll();
  }
  std::string Page(const std::string& path) {
    const auto page = AnswerPage(Context(), path, "");
    EXPECT_TRUE(page) << Sentence(page.error());
    return page ? page->body : "";
  }
  json Ask(const std::string& verb, const json& parameters) {
    const auto answer = Answer(Context(), verb, parameters.dump());
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  [[nodiscard]] std::string Report() const {
    std::stringstream page;
    page << std::ifstream(store_->ReportFolder() / "r" / std::to_string(revisions_.back().number) / "index.html")
                .rdbuf();
    return page.str();
  }
  [[nodiscard]] formats::RevisionInput Newest() const {
    return *formats::ReadRevisionDocument(revisions_.back().document);
  }
  [[nodiscard]] std::string Said() const {
    return revisions_.back().verdict.why + " " + revisions_.back().verdict.what_to_do;
  }

  // Of left, mast, right and top. Good edges of `pairs`; where none is of the mast, one of it that failed.
  SessionId Visit(const std::vector<std::pair<const char*, const char*>>& pairs) {
    clock_.now.ns += 86'400'000'000'000;
    Manifest manifest;
    manifest.header.robot = kRobot;
    manifest.header.reference = SensorId("left");
    manifest.header.captured_at = clock_.now;
    manifest.header.targets = {{TargetId("board"), 9, 6, 0.025, 0.0001, "B-7"}};
    for (const char* name : {"left", "mast", "right", "top"}) {
      manifest.header.sensors.emplace_back().id = SensorId(name);
      AddFile(std::string(name) + "/1.png", name + ToIso(clock_.now), manifest);
    }
    const SessionId session = Close(manifest);
    FinishJobs();
    std::vector<Edge> edges;
    for (const auto& [a, b] : pairs) edges.push_back(GivenEdge("r", a, b, PlaceOf(b) - PlaceOf(a)));
    if (std::none_of(edges.begin(), edges.end(), [](const Edge& edge) { return edge.frame_b == kMast; })) {
      edges.push_back(GivenEdge("r", "left", "mast", 0.0));
      edges.back().state = EdgeState::kFailed;
      edges.back().diagnoses = {{"no_view", "seen by neither", "Show it."}};
    }
    for (Edge& edge : edges) {
      edge.session = session;
      edge.id = EstimatedEdgeId(kRobot, session, edge.method, edge.frame_a, edge.frame_b);
    }
    StoreEdges(edges);
    StepAll();
    return session;
  }
  void FinishJobs() {
    for (auto job = storage::LoadNextJob(*store_, {}); job && *job; job = storage::LoadNextJob(*store_, {}))
      ASSERT_TRUE(store_->Write([&] { return storage::FinishJob(*store_, (*job)->number, clock_.now); }));
  }
  static double PlaceOf(const std::string& sensor) {
    return sensor == "left" ? 0 : sensor == "right" ? 1 : sensor == "top" ? 3 : 7;
  }

  RevisionCache cache_;
};

const std::vector<std::pair<const char*, const char*>> kWithoutMast = {
    {"left", "right"}, {"right", "top"}, {"left", "top"}};

TEST_F(RetiredSensorTest, AskedForAPoseOfWhichAllIsPastOneIsToldWhy) {
  const SessionId session = Visit(kWithoutMast);
  MustOrder("retire", session.str());
  const json newest = {{"robot", "r"}, {"a", "left"}, {"b", "top"}, {"revision", revisions_.back().number}};
  const auto answer = Answer(Context(), "lookup", newest.dump());
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().what, AllOf(HasSubstr("nothing counts any more"), HasSubstr("was retired")));
  EXPECT_THAT(answer.error().cure, HasSubstr("restore"));
}

TEST_F(RetiredSensorTest, IsPastAndNobodyAsksForIt) {
  const SessionId session = Visit(kWithoutMast);
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(Said(), HasSubstr("mast"));
  const auto done = Order("retire", "mast");
  ASSERT_TRUE(done) << Sentence(done.error());
  const json answer = json::parse(done->document);
  EXPECT_EQ(answer["sensor"], "mast");
  EXPECT_EQ(answer["standing"]["how"], "retired");
  EXPECT_EQ(answer["revision_follows"], true);
  StepAll();

  EXPECT_TRUE(IsUsable(revisions_.back().verdict)) << Said();
  EXPECT_THAT(Said(), Not(HasSubstr("mast")));
  EXPECT_THAT(Newest().retired, ElementsAre(RetiredSensor{kMast, {clock_.now, "Ada", "taken off"}}));
  std::vector<std::string> posed;
  for (const SensorPose& pose : poses_) posed.push_back(pose.sensor.str());
  EXPECT_THAT(posed, ElementsAre("left", "right", "top"));
  int past = 0;
  for (const Edge& edge : Newest().edges) {
    if (edge.frame_a != kMast && edge.frame_b != kMast) continue;
    ++past;
    EXPECT_TRUE(IsPast(edge));
    EXPECT_EQ(edge.diagnoses.front().what, "mast was retired on 2027-01-16 by Ada: taken off");
    EXPECT_EQ(edge.diagnoses.front().cure, "`rigcal restore mast --robot r` brings it back.");
  }
  EXPECT_EQ(past, 1);
  EXPECT_EQ(live_.Of(kRobot).solver->graph().sensors.size(), 3u);

  const auto shown = AllOf(HasSubstr("mast was retired on 2027-01-16 by Ada: taken off"),
                           HasSubstr("<code class=\"typed\">rigcal restore mast --robot r</code>"));
  EXPECT_THAT(Report(), shown);
  EXPECT_THAT(Page("/robots/r/"), shown);
  EXPECT_THAT(Page("/robots/r/sessions/" + session.str() + "/"), shown);
  EXPECT_EQ(Ask("sensor_names", {{"robot", "r"}})["sensors"], json::array({"left", "right", "top"}));
  const auto lookup = Answer(Context(), "lookup", R"({"robot":"r","a":"left","b":"mast"})");
  ASSERT_FALSE(lookup);
  EXPECT_EQ(Sentence(lookup.error()),
            "mast was retired on 2027-01-16 by Ada: taken off. `rigcal restore mast --robot r` brings it back.");

  ASSERT_TRUE(Order("retire", "mast"));
  EXPECT_EQ(StepAll(), 0);  // twice is once
}

TEST_F(RetiredSensorTest, ThePagesHaveTheCommandsToTakeThingsOut) {
  const SessionId session = Visit(kWithoutMast);
  const Edge* good = nullptr;
  const formats::RevisionInput newest = Newest();
  for (const Edge& edge : newest.edges)
    if (edge.state == EdgeState::kGood) good = &edge;
  ASSERT_NE(good, nullptr);
  const std::string edge = "rigcal retire " + good->id.str().substr(0, 16) + " --reason &quot;WHY&quot;</code>";
  EXPECT_THAT(Report(),
              AllOf(HasSubstr(edge), HasSubstr("rigcal retire left --robot r --reason &quot;WHY&quot;</code>"),
                    HasSubstr("rigcal retire mast --robot r --reason &quot;WHY&quot;</code>")));
  EXPECT_THAT(Page("/robots/r/sessions/" + session.str() + "/"),
              AllOf(HasSubstr(edge),
                    HasSubstr("rigcal retire " + session.str().substr(0, 16) + " --reason &quot;WHY&quot;</code>")));
}

TEST_F(RetiredSensorTest, StaysRetiredWhenALaterSessionBringsItAndIsRestored) {
  Visit(kWithoutMast);
  MustOrder("retire", "mast");
  std::vector<std::pair<const char*, const char*>> all = kWithoutMast;
  all.emplace_back("left", "mast");
  const SessionId later = Visit(all);
  EXPECT_TRUE(IsUsable(revisions_.back().verdict)) << Said();
  EXPECT_EQ(poses_.size(), 3u);
  const json shown = Ask("session", {{"id", later.str()}});
  ASSERT_EQ(shown["retired_sensors"].size(), 1u);
  EXPECT_EQ(shown["retired_sensors"][0]["sensor"], "mast");
  EXPECT_EQ(shown["retired_sensors"][0]["reason"], "taken off");
  EXPECT_THAT(Page("/robots/r/sessions/" + later.str() + "/"),
              AllOf(HasSubstr("mast was retired on "), HasSubstr("what this session says of it does not count")));

  MustOrder("restore", "mast");
  EXPECT_TRUE(Newest().retired.empty());
  ASSERT_EQ(poses_.size(), 4u);
  for (const SensorPose& pose : poses_) EXPECT_NEAR(pose.T_ref_sensor.p_m.x(), PlaceOf(pose.sensor.str()), 1e-9);
  EXPECT_EQ(live_.Of(kRobot).solver->graph().sensors.size(), 4u);
  EXPECT_THAT(Page("/robots/r/"), Not(HasSubstr("was retired on")));
}

// The next reference is the one that names itself: no session names another here.
TEST_F(RetiredSensorTest, AnotherBecomesTheReferenceWhereTheOthersAreTied) {
  Visit(kWithoutMast);
  MustOrder("retire", "left");
  EXPECT_EQ(Newest().reference, SensorId("right"));
  for (const SensorPose& pose : poses_)
    EXPECT_NEAR(pose.T_ref_sensor.p_m.x(), pose.known ? PlaceOf(pose.sensor.str()) - PlaceOf("right") : 0.0, 1e-9);
  MustOrder("restore", "left");
  EXPECT_EQ(Newest().reference, SensorId("left"));
}

TEST_F(RetiredSensorTest, TheReferenceIsKeptWhereNoneCanTakeItsPlace) {
  const auto refused = [&](std::vector<Edge> edges) {
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
    const auto done = Order("retire", "a");
    EXPECT_FALSE(done);
    EXPECT_TRUE(storage::LoadRetiredSensors(*store_, kRobot)->empty());
    EXPECT_EQ(StepAll(), 0);
    return done ? Error{} : done.error();
  };
  const Error none = refused({GivenEdge("r", "a", "b", 1.0), GivenEdge("r", "a", "c", 2.0)});
  EXPECT_EQ(none.code, ErrorCode::kConflict);
  EXPECT_EQ(Sentence(none),
            "sensor a is the reference that all others are told in, and no good edge ties any two of the others. Push "
            "a session, or "
            "edges, that tie the others to each other; then retire a.");
  EXPECT_EQ(Sentence(refused({GivenEdge("r", "c", "d", 1.0)})),
            "sensor a is the reference that all others are told in, and nothing else ties b to c. Push a session, or "
            "edges, that tie "
            "b to c without it; then retire a.");
  std::vector<Edge> tie = {GivenEdge("r", "b", "d", 2.0)};
  AssignPushedIds(tie);
  StoreEdges(tie);
  StepAll();
  MustOrder("retire", "a");
  EXPECT_EQ(Newest().reference, SensorId("b"));
}

TEST_F(RetiredSensorTest, TheOrderInWhichThingsComeDoesNotMatter) {
  std::vector<Edge> first = Triangle("r"), second = {GivenEdge("r", "a", "d", 4.0), GivenEdge("r", "c", "d", 2.0)};
  second.push_back(GivenEdge("r", "a", "c", 2.001));
  AssignPushedIds(second);
  StoreEdges(first);
  StoreEdges({second.front()});
  StepAll();
  MustOrder("retire", "d");
  StoreEdges({second[1], second[2]});
  StepAll();
  const std::string document = revisions_.back().document;

  store_.reset();
  store_ = std::make_unique<storage::Store>(std::move(*storage::Store::Open(folder_ / "other")));
  LiveGraphs live;
  const auto step_all = [&] {
    for (int i = 0; i < 100; ++i) {
      const auto stepped = Step({*store_, clock_, live, claims_, announcer_, cameras_});
      if (!stepped || !stepped->worked) return;
    }
  };
  for (const std::size_t i : {2U, 1U, 0U}) StoreEdges({second[i]});
  StoreEdges(first);
  ASSERT_TRUE(Order("retire", "d"));
  step_all();
  EXPECT_EQ(revisions_.back().document, document);
}

TEST_F(RetiredSensorTest, ACrashBetweenTheOrderAndItsRevisionLosesNothing) {
  StoreEdges(Triangle("r"));
  StepAll();
  ASSERT_TRUE(Order("retire", "c"));
  store_.reset();
  store_ = std::make_unique<storage::Store>(std::move(*storage::Store::Open(folder_)));
  LiveGraphs live;
  RobotLocks claims;
  const auto step = Step({*store_, clock_, live, claims, announcer_, cameras_});
  ASSERT_TRUE(step && step->worked);
  EXPECT_EQ(poses_.size(), 2u);
}

TEST_F(RetiredSensorTest, WhatIsNamedIsFoundOrSaidNotToBe) {
  StoreEdges(Triangle("r"));
  StepAll();
  const auto refused = [&](const std::string& thing, const std::string& robot) {
    const auto done = Order("retire", thing, robot);
    EXPECT_FALSE(done) << thing;
    return done ? std::string() : done.error().what;
  };
  EXPECT_THAT(refused("z", "r"), HasSubstr("robot 'r' has no sensor 'z'"));
  EXPECT_THAT(refused("c", "rr"), HasSubstr("robot 'rr' is not known"));
  EXPECT_THAT(refused(std::string(64, '0'), "r"), HasSubstr("no edge or session of robot r begins with"));
  const auto nameless = CarryOut(*store_, clock_, "retire", R"({"thing":"c","who":"Ada","reason":"x"})");
  ASSERT_FALSE(nameless);
  EXPECT_THAT(nameless.error().cure, HasSubstr("--robot ROBOT"));
  EXPECT_THAT(CarryOut(*store_, clock_, "retire", R"({"who":"Ada","reason":"x"})").error().what,
              HasSubstr("'thing' is missing"));
  EXPECT_EQ(StepAll(), 0);
}

}  // namespace
}  // namespace rigcal::pipeline

// Restore and retire: from the order to the revision, the live graph and what is shown.
#include "server/pipeline/orders/orders.h"

#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>

#include "server/model/edges/past.h"
#include "server/pipeline/answers/answer.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class OrdersTest : public PipelineTest {
 protected:
  Result<OrderDone> Order(const std::string& verb, const json& parameters) {
    return CarryOut(*store_, clock_, verb, parameters.dump());
  }
  Error Refused(const std::string& verb, const json& parameters) {
    const auto done = Order(verb, parameters);
    EXPECT_FALSE(done) << done->document;
    return done ? Error{} : done.error();
  }
  std::string Ask(const std::string& verb, const json& parameters) {
    RevisionCache revisions;
    const auto answer = Answer({*store_, clock_, revisions, {}, ""}, verb, parameters.dump());
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return answer.value_or("{}");
  }
  std::string Page(const std::string& path) {
    RevisionCache revisions;
    const auto page = AnswerPage({*store_, clock_, revisions, {}, ""}, path, "");
    EXPECT_TRUE(page) << Sentence(page.error());
    return page ? page->body : "";
  }
  // A session of the same two pictures, and a good edge that it gave.
  SessionId SessionWithEdge(double x_m) {
    clock_.now.ns += 1'000'000'000;
    const SessionId session = StoreSession("r", {{"left/01.png", "one"}, {"right/01.png", "two"}});
    Edge edge = GivenEdge("r", "left", "right", x_m);
    edge.session = session;
    edge.method = "given";
    edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
    StoreEdges({edge});
    StepAll();
    return session;
  }
  // Where the right sensor is by the newest revision.
  double RightAt() {
    for (const SensorPose& pose : poses_)
      if (pose.sensor.str() == "right") return pose.T_ref_sensor.p_m.x();
    return -1;
  }
  // The same by the live graph.
  double LiveRightAt() {
    for (const SensorPose& pose : live_.Of(RobotId("r")).solver->Snapshot().poses)
      if (pose.sensor.str() == "right") return pose.T_ref_sensor.p_m.x();
    return -1;
  }
};

TEST_F(OrdersTest, ARestoredSessionTakesItsPlaceBack) {
  const SessionId right = SessionWithEdge(0.1), wrong = SessionWithEdge(0.2);
  EXPECT_NEAR(RightAt(), 0.2, 1e-9);
  const std::size_t revisions = revisions_.size();
  const auto done =
      Order("restore", {{"session", right.str().substr(0, 8)}, {"who", "Ada"}, {"reason", "wrong squares"}});
  ASSERT_TRUE(done) << Sentence(done.error());
  EXPECT_EQ(done->robot, RobotId("r"));
  const json row = json::parse(done->document)["session"];
  EXPECT_EQ(row["session"], right.str());
  EXPECT_EQ(row["standing"]["how"], "restored");
  EXPECT_EQ(row["supersedes"], json::array({wrong.str()}));
  EXPECT_TRUE(json::parse(done->document)["revision_follows"]);
  EXPECT_EQ(StepAll(), 2);  // revise, publish
  ASSERT_EQ(revisions_.size(), revisions + 1);
  EXPECT_NEAR(RightAt(), 0.1, 1e-9);
  EXPECT_NEAR(LiveRightAt(), 0.1, 1e-9);
  EXPECT_GE(json::parse(Ask("show", {{"robot", "r"}}))["standing"].get<int>(), row["standing"]["number"].get<int>());
  EXPECT_THAT(revisions_.back().document, HasSubstr("session " + wrong.str().substr(0, 16) +
                                                    " is superseded by session " + right.str().substr(0, 16)));
  EXPECT_THAT(revisions_.back().document, HasSubstr("`rigcal restore " + wrong.str().substr(0, 16) + "`"));

  ASSERT_TRUE(Order("restore", {{"session", right.str()}, {"who", "Bob"}}));
  EXPECT_EQ(StepAll(), 0);  // twice is once
  const json sessions = json::parse(Ask("sessions", {{"robot", "r"}}))["sessions"];
  for (const json& session : sessions) {
    if (session["session"] == right.str()) {
      EXPECT_TRUE(session["superseded_by"].is_null());
      EXPECT_EQ(session["standing"]["who"], "Ada");
      continue;
    }
    EXPECT_EQ(session["superseded_by"]["session"], right.str());
    EXPECT_EQ(session["superseded_by"]["standing"]["reason"], "wrong squares");
  }
  EXPECT_THAT(Page("/robots/r/"),
              HasSubstr("<code class=\"typed\">rigcal restore " + wrong.str().substr(0, 16) + "</code>"));
  EXPECT_THAT(Page("/robots/r/sessions/" + wrong.str() + "/"), HasSubstr("restored by Ada (wrong squares)"));
}

TEST_F(OrdersTest, ACrashBetweenOrderAndRevisionLosesNothing) {
  const SessionId right = SessionWithEdge(0.1);
  SessionWithEdge(0.2);
  ASSERT_TRUE(Order("restore", {{"session", right.str()}, {"who", "Ada"}}));
  store_.reset();
  store_ = std::make_unique<storage::Store>(std::move(*storage::Store::Open(folder_)));
  LiveGraphs live;
  RobotLocks claims;
  const auto step = Step({*store_, clock_, live, claims, announcer_, cameras_});
  ASSERT_TRUE(step && step->worked);
  EXPECT_NEAR(RightAt(), 0.1, 1e-9);
}

TEST_F(OrdersTest, ARetiredEdgeIsPastForGood) {
  std::vector<Edge> edges = Triangle("r");
  edges.push_back(GivenEdge("r", "a", "c", 12.0));  // 2.0, typed wrong
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  EXPECT_NE(revisions_.back().verdict.level, VerdictLevel::kPass);
  const std::string id = edges.back().id.str();
  const auto done = Order("retire", {{"edge", id.substr(0, 12)}, {"who", "Ada"}, {"reason", "typed 12 for 2"}});
  ASSERT_TRUE(done) << Sentence(done.error());
  const json shown = json::parse(done->document);
  EXPECT_EQ(shown["edge"]["id"], id);
  EXPECT_EQ(shown["edge"]["diagnoses"][0]["code"], "retired");
  EXPECT_EQ(shown["standing"]["who"], "Ada");
  EXPECT_EQ(StepAll(), 2);
  const auto revision = formats::ReadRevisionDocument(revisions_.back().document);
  ASSERT_TRUE(revision);
  for (const Edge& edge : revision->edges) EXPECT_EQ(IsPast(edge), edge.id.str() == id);
  EXPECT_THAT(revisions_.back().document, HasSubstr("retired on 2027-01-15 by Ada: typed 12 for 2"));
  EXPECT_NEAR(poses_[2].T_ref_sensor.p_m.x(), 2.002, 1e-9);
  EXPECT_EQ(live_.Of(RobotId("r")).solver->graph().edges.size(), 3u);

  StoreEdges({edges.back()});  // pushed again
  EXPECT_EQ(StepAll(), 0);
  ASSERT_TRUE(Order("retire", {{"edge", id}, {"who", "Bob"}, {"reason", "me too"}}));
  EXPECT_EQ(StepAll(), 0);
  EXPECT_EQ(storage::LoadRetired(*store_, RobotId("r"))->at(edges.back().id).word.who, "Ada");
  const json listed = json::parse(Ask("edges", {{"robot", "r"}}))["edges"];
  EXPECT_EQ(listed.size(), 4u);
  for (const json& edge : listed) EXPECT_EQ(edge["state"] == "failed", edge["id"] == id);
}

TEST_F(OrdersTest, AnEstimatedEdgeCanBeRetiredToo) {
  SessionWithEdge(0.1);
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), false).value();
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    ASSERT_TRUE(Order("retire", {{"edge", edge.id.str()}, {"who", "Ada"}, {"reason", "bumped"}}));
  }
  StepAll();
  EXPECT_EQ(revisions_.back().document.find("\"state\":\"good\""), std::string::npos);
  EXPECT_NE(revisions_.back().verdict.level, VerdictLevel::kPass);
}

TEST_F(OrdersTest, ARetiredEdgeIsRestored) {
  std::vector<Edge> edges = Triangle("r");
  StoreEdges(edges);
  StepAll();
  const std::string before = revisions_.back().document, id = edges[2].id.str();
  ASSERT_TRUE(Order("retire", {{"thing", id.substr(0, 8)}, {"who", "Ada"}, {"reason", "mistaken"}}));
  StepAll();
  EXPECT_NE(revisions_.back().document, before);
  const auto done = Order("restore", {{"thing", id}, {"who", "Ada"}});
  ASSERT_TRUE(done) << Sentence(done.error());
  EXPECT_EQ(json::parse(done->document)["edge"]["state"], "good");
  EXPECT_EQ(json::parse(done->document)["standing"]["how"], "restored");
  StepAll();
  EXPECT_EQ(revisions_.back().document, before);
  EXPECT_EQ(live_.Of(RobotId("r")).solver->graph().edges.size(), 3u);
}

TEST_F(OrdersTest, ARetiredSessionIsPastUntilItIsRestored) {
  const SessionId session = SessionWithEdge(0.1);
  const std::string command = "rigcal restore " + session.str().substr(0, 16);
  const auto done = Order("retire", {{"thing", session.str().substr(0, 8)}, {"who", "Ada"}, {"reason", "blurred"}});
  ASSERT_TRUE(done) << Sentence(done.error());
  EXPECT_EQ(json::parse(done->document)["session"]["retired"]["reason"], "blurred");
  StepAll();
  EXPECT_EQ(revisions_.back().verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(revisions_.back().verdict.why, HasSubstr("All that was calibrated is past"));
  EXPECT_FALSE(revisions_.back().calibrated_at);
  const formats::RevisionInput document = *formats::ReadRevisionDocument(revisions_.back().document);
  for (const Edge& edge : document.edges) {
    EXPECT_TRUE(IsPast(edge));
    EXPECT_THAT(edge.diagnoses.front().what, HasSubstr("was retired on 2027-01-15 by Ada: blurred"));
  }
  EXPECT_THAT(Page("/robots/r/"), HasSubstr("<code class=\"typed\">" + command + "</code>"));
  EXPECT_THAT(Page("/robots/r/sessions/" + session.str() + "/"),
              HasSubstr("This session does not count: it was retired on 2027-01-15 by Ada: blurred."));
  const auto again =
      storage::MakeCurrent(*store_, session, storage::MadeCurrent::kPushedAgain, {clock_.now, "robot r", ""});
  EXPECT_FALSE(*again);  // pushed again it stays retired
  ASSERT_TRUE(Order("restore", {{"thing", session.str()}, {"who", "Ada"}}));
  StepAll();
  EXPECT_NEAR(RightAt(), 0.1, 1e-9);
  EXPECT_TRUE(json::parse(Ask("sessions", {{"robot", "r"}}))["sessions"][0]["retired"].is_null());
}

TEST_F(OrdersTest, WhatCannotBeDoneSaysWhy) {
  const SessionId session = SessionWithEdge(0.1);
  EXPECT_EQ(Refused("restore", {{"session", "0123456"}, {"who", "Ada"}}).code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Refused("restore", {{"session", std::string(64, '0')}, {"who", "Ada"}}).code, ErrorCode::kNotFound);
  EXPECT_EQ(Refused("restore", {{"session", session.str()}}).code, ErrorCode::kInvalidInput);  // by whom?
  const Error other = Refused("restore", {{"session", session.str()}, {"who", "Ada"}, {"robot", "s"}});
  EXPECT_EQ(other.code, ErrorCode::kNotFound);
  EXPECT_THAT(other.what, HasSubstr("of robot s"));
  EXPECT_EQ(Refused("retire", {{"edge", std::string(64, '0')}, {"who", "Ada"}, {"reason", "x"}}).code,
            ErrorCode::kNotFound);
  const EdgeId edge = storage::LoadEdges(*store_, RobotId("r"), false)->front().id;
  EXPECT_EQ(Refused("retire", {{"edge", edge.str()}, {"who", "Ada"}}).code, ErrorCode::kInvalidInput);  // why?
  EXPECT_EQ(StepAll(), 0);
}

TEST_F(OrdersTest, EachHasARole) {
  const std::map<std::string, Role> roles = {{"restore", Role::kTechnician}, {"retire", Role::kTechnician},
                                             {"epoch", Role::kTechnician},   {"measure_board", Role::kTechnician},
                                             {"resolve", Role::kTechnician}, {"approve", Role::kApprover},
                                             {"reject", Role::kApprover},    {"rollback", Role::kApprover},
                                             {"set_policy", Role::kAdmin},   {"set_rig_model", Role::kAdmin}};
  for (const auto& [verb, role] : roles) EXPECT_EQ(RoleOfOrder(verb), role) << verb;
  EXPECT_FALSE(RoleOfOrder("sessions"));
  EXPECT_FALSE(RoleOfOrder(""));
}

// GET asks, and no more.
TEST_F(OrdersTest, APageGivesNoOrders) {
  SessionWithEdge(0.1);
  RevisionCache revisions;
  for (const char* verb : {"restore", "retire"}) {
    EXPECT_TRUE(IsOrder(verb));
    EXPECT_FALSE(AnswerPage({*store_, clock_, revisions, {}, ""}, std::string("/api/v1/") + verb, "who=x&edge=y"));
  }
  EXPECT_FALSE(IsOrder("sessions"));
}

}  // namespace
}  // namespace rigcal::pipeline

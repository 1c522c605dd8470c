// From the candidate to the calibration that robots use: by the policy, by a person, back again; and what is told of
// it.
#include "server/pipeline/robots/decide.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "storage/audit.h"
#include "storage/fleet/robot_runs.h"
#include "storage/revisions/decisions.h"
#include "storage/sessions/retired.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class DecideTest : public PipelineTest {
 protected:
  Result<OrderDone> Order(const std::string& verb, json parameters) {
    if (!parameters.contains("robot")) parameters["robot"] = "r";
    if (!parameters.contains("who")) parameters["who"] = "Ada";
    if (!parameters.contains("reason")) parameters["reason"] = "checked";
    return CarryOut(*store_, clock_, verb, parameters.dump());
  }
  json Done(const std::string& verb, const json& parameters) {
    const auto done = Order(verb, parameters);
    EXPECT_TRUE(done) << Sentence(done.error());
    return done ? json::parse(done->document) : json();
  }
  Result<std::string> Asked(const std::string& verb, json parameters) {
    RevisionCache revisions;
    parameters["robot"] = "r";
    return Answer({*store_, clock_, revisions, {}, ""}, verb, parameters.dump());
  }
  json Ask(const std::string& verb, const json& parameters = json::object()) {
    const auto answer = Asked(verb, parameters);
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  std::string Page() {
    RevisionCache revisions;
    const auto page = AnswerPage({*store_, clock_, revisions, {}, ""}, "/robots/r/", "");
    EXPECT_TRUE(page) << Sentence(page.error());
    return page ? page->body : "";
  }
  // Of the fleet.
  void SetPolicy(const std::string& text) {
    const json parameters = {{"text", text}, {"who", "Eve"}, {"reason", "we look at each"}};
    const auto set = CarryOut(*store_, clock_, "set_policy", parameters.dump());
    EXPECT_TRUE(set) << Sentence(set.error());
  }
  // A revision that passes, of three sensors.
  void Push(double ab_m) {
    std::vector<Edge> edges = {GivenEdge("r", "a", "b", ab_m), GivenEdge("r", "b", "c", 1.0),
                               GivenEdge("r", "a", "c", 1.0 + ab_m)};
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
  }
  // That with one more sensor.
  void PushWithD() {
    std::vector<Edge> edges = {GivenEdge("r", "a", "d", 3.0), GivenEdge("r", "b", "d", 2.0)};
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
  }
  // What whoever begins to read is told now.
  int Announced() {
    const auto state = LoadRobotState(*store_, RobotId("r"));
    return state && *state && (*state)->calibration ? (*state)->calibration->revision.number : 0;
  }
  void Reopen() {
    store_.reset();
    store_ = std::make_unique<storage::Store>(std::move(*storage::Store::Open(folder_)));
  }
};

TEST_F(DecideTest, ThePolicyApprovesAPassOnce) {
  Push(1.0);
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kPass) << revisions_.back().verdict.why;
  EXPECT_EQ(InUse(), 1);
  Reopen();
  StepAll();
  const json shown = Ask("show");
  EXPECT_EQ(shown["state"], "approved");
  EXPECT_EQ(shown["decision"]["who"], "policy");
  EXPECT_EQ(shown["in_use"]["revision"], 1);
  const auto rows = storage::LoadAudit(*store_, RobotId("r")).value();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].what, "approved revision 1 of robot r: the verdict is pass");
  EXPECT_FALSE(storage::VerifyAudit(*store_)->fault);
}

TEST_F(DecideTest, WhereAPersonApprovesNothingIsToldBefore) {
  Push(1.0);
  SetPolicy("approval: person");
  StepAll();
  EXPECT_EQ(Announced(), 1) << "judged anew, the same poses wait as well";
  Push(1.0001);
  const int candidate = revisions_.back().number;
  EXPECT_EQ(Announced(), 1);
  const json shown = Ask("show");
  EXPECT_EQ(shown["revision"], candidate);
  EXPECT_EQ(shown["state"], "candidate");
  EXPECT_TRUE(shown["decision"].is_null());
  EXPECT_EQ(Ask("status")["robots"][0]["state"], "candidate");
  EXPECT_EQ(Ask("status")["robots"][0]["drive"]["kind"], "to_approve");
  EXPECT_THAT(Page(), HasSubstr("<strong>What to do:</strong> <code class=\"typed\">rigcal approve r "));
  const std::string command = "rigcal approve r " + std::to_string(candidate) + " --reason TEXT";
  EXPECT_THAT(Page(), HasSubstr(command));
  Reopen();
  EXPECT_EQ(StepAll(), 0);
  EXPECT_EQ(Announced(), 1);

  const json done = Done("approve", {{"revision", candidate}, {"reason", "checked against the wall"}});
  EXPECT_EQ(done["revision"], candidate);
  EXPECT_EQ(done["state"], "approved");
  EXPECT_EQ(done["revision_follows"], false);
  EXPECT_EQ(done["in_use"], (json{{"revision", candidate},
                                  {"how", "approved"},
                                  {"at", ToIso(clock_.now)},
                                  {"who", "Ada"},
                                  {"reason", "checked against the wall"}}));
  Reopen();
  EXPECT_EQ(Announced(), candidate);
  EXPECT_THAT(Page(), testing::Not(HasSubstr("rigcal approve")));
  EXPECT_EQ(StepAll(), 0);
}

TEST_F(DecideTest, WithNothingInUseThereIsNoCalibrationToLookUp) {
  Push(1.0);
  Done("reject", {{"revision", 1}});
  EXPECT_EQ(Announced(), 0);
  const auto state = LoadRobotState(*store_, RobotId("r")).value();
  EXPECT_EQ(state->withdrawn.size(), 3u);
  const auto refused = Asked("lookup", {{"a", "a"}, {"b", "b"}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().what, HasSubstr("No calibration of r is in use; this one was rejected by Ada"));
  EXPECT_EQ(Ask("lookup", {{"a", "a"}, {"b", "b"}, {"revision", 1}})["state"], "rejected");
  Done("approve", {{"revision", 1}});
  EXPECT_EQ(Ask("lookup", {{"a", "a"}, {"b", "b"}})["revision"], 1);
}

TEST_F(DecideTest, ARollbackIsToldWithTheSensorsThatItTakesBack) {
  Push(1.0);
  PushWithD();
  ASSERT_EQ(InUse(), 2) << revisions_.back().verdict.why;
  const auto done = Order("rollback", {{"revision", 1}, {"reason", "d was loose"}});
  ASSERT_TRUE(done) << Sentence(done.error());
  EXPECT_EQ(done->decided, 1);
  Reopen();
  const auto state = LoadRobotState(*store_, RobotId("r")).value();
  ASSERT_TRUE(state->calibration);
  EXPECT_EQ(state->calibration->revision.number, 1);
  EXPECT_EQ(state->withdrawn, (std::vector<SensorId>{SensorId("d")}));
  EXPECT_EQ(Ask("lookup", {{"a", "a"}, {"b", "b"}})["revision"], 1);
  const json revisions = Ask("revisions")["revisions"];
  EXPECT_EQ(revisions[0]["state"], "rolled_back");
  EXPECT_EQ(revisions[1]["state"], "approved");
  EXPECT_EQ(revisions[1]["decision"]["how"], "rolled_back");
  EXPECT_THAT(Page(), HasSubstr("In use: revision 1 (rolled back to by Ada, "));
  EXPECT_EQ(storage::LoadAudit(*store_, RobotId("r"))->front().what, "rolled robot r back to revision 1: d was loose");
  Done("rollback", {{"revision", 2}});
  EXPECT_EQ(Announced(), 2);
}

TEST_F(DecideTest, WhatWasRetiredSinceIsNotRolledBackTo) {
  std::vector<Edge> wrong = {GivenEdge("r", "a", "b", 1.0)};
  AssignPushedIds(wrong);
  StoreEdges(wrong);
  StepAll();
  ASSERT_EQ(InUse(), 1) << revisions_.back().verdict.why;
  ASSERT_TRUE(storage::RetireEdge(*store_, wrong[0].id, {clock_.now, "Ada", "typed wrong"}));
  Push(1.0001);
  const std::size_t rows = storage::LoadAudit(*store_, RobotId())->size();
  const auto refused = Order("rollback", {{"revision", 1}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_EQ(storage::LoadAudit(*store_, RobotId())->size(), rows) << "it leaves no trace";
  EXPECT_EQ(Announced(), 2);
}

TEST_F(DecideTest, WarningsMayNeedAPersonAndAFailIsNeverApproved) {
  SetPolicy("approve_warnings: false\npairs: {a - b: {tolerance_mm: 0.001}}\n");
  Push(1.0);
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kWarn) << revisions_.back().verdict.why;
  EXPECT_EQ(Announced(), 0);
  SetPolicy("pairs: {a - b: {tolerance_mm: 0.001}}\n");
  StepAll();
  EXPECT_EQ(Announced(), 2) << "by default a warning is approved";
  std::vector<Edge> contradiction = {GivenEdge("r", "a", "c", 9.0)};
  AssignPushedIds(contradiction);
  StoreEdges(contradiction);
  StepAll();
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(Announced(), 2);
  EXPECT_EQ(Ask("show")["state"], "unusable");
  const auto refused = Order("approve", {{"revision", 3}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("has the verdict fail"));
}

TEST_F(DecideTest, WhatIsMissingOrWrongIsToldByName) {
  Push(1.0);
  const auto refused = [&](const std::string& verb, const json& parameters) {
    const auto done = Order(verb, parameters);
    return done ? "" : NameOf(done.error().code) + ": " + done.error().what;
  };
  EXPECT_THAT(refused("approve", {{"reason", " "}}), HasSubstr("reason"));
  EXPECT_THAT(refused("approve", {{"who", ""}}), HasSubstr("who"));
  for (const char* verb : {"approve", "reject", "rollback"})
    EXPECT_THAT(refused(verb, {{"who", "Policy"}, {"revision", 1}}), HasSubstr("the name by which the policy itself"));
  for (const char* verb : {"retire", "epoch", "set_policy", "set_rig_model", "measure_board"})
    EXPECT_THAT(refused(verb, {{"who", "policy"}, {"sensor", "a"}, {"serial", "B-7"}}),
                HasSubstr("the name by which the policy itself"))
        << verb;
  EXPECT_THAT(refused("rollback", json::object()), HasSubstr("invalid_input: the parameter 'revision'"));
  EXPECT_EQ(refused("approve", {{"revision", 9}}), "not_found: robot 'r' has no revision 9");
  EXPECT_THAT(refused("reject", {{"robot", "nobody"}}), HasSubstr("not_found"));
  EXPECT_TRUE(IsOrder("approve") && IsOrder("reject") && IsOrder("rollback"));
}

// Of several candidates the newest is named, and nothing is approved that nobody looked at.
TEST_F(DecideTest, WithoutANumberNothingIsDecided) {
  SetPolicy("approval: person");
  Push(1.0);
  Push(1.0001);
  for (const json& parameters : {json::object(), json::object({{"revision", 0}})}) {
    const auto refused = Order("approve", parameters);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
    EXPECT_THAT(refused.error().cure,
                HasSubstr("revision 2 is the newest candidate, `rigcal approve r 2 --reason TEXT`"));
  }
  EXPECT_EQ(Announced(), 0);
  Done("approve", {{"revision", 1}});
  EXPECT_THAT(Order("reject", {}).error().cure, HasSubstr("revision 1 is in use, `rigcal reject r 1 --reason TEXT`"));
  EXPECT_THAT(Order("rollback", {}).error().cure, HasSubstr("rigcal history r"));
}

class HeldBackTest : public DecideTest {
 protected:
  // Of three sensors, and of one edge that is between two of them once more.
  void SetUpTwoRevisions() {
    Push(1.0);
    std::vector<Edge> once_more = {GivenEdge("r", "a", "b", 1.0001)};
    AssignPushedIds(once_more);
    StoreEdges(once_more);
    StepAll();
    once_more_ = once_more.front().id;
    ASSERT_EQ(InUse(), 2) << revisions_.back().verdict.why;
  }
  void RetireAndRestore() {
    Done("retire", {{"edge", once_more_.str()}, {"reason", "perhaps wrong"}});
    StepAll();
    Done("restore", {{"edge", once_more_.str()}, {"reason", "it was right"}});
    StepAll();
  }
  int Newest() { return revisions_.back().number; }

  EdgeId once_more_;
};

TEST_F(HeldBackTest, ARejectionIsNotUndoneByARetireAndRestore) {
  SetUpTwoRevisions();
  Done("reject", {{"revision", 2}, {"reason", "the mast was bent"}});
  ASSERT_EQ(Announced(), 1);
  RetireAndRestore();
  ASSERT_GE(Newest(), 4);
  EXPECT_EQ(revisions_.back().digest, revisions_[1].digest) << "the same poses by another number";
  EXPECT_EQ(Announced(), 1);
  EXPECT_EQ(Ask("show")["state"], "rejected") << "nobody is asked to approve it";
}

TEST_F(HeldBackTest, ARejectionIsNotUndoneByAPolicyForTheFleet) {
  SetUpTwoRevisions();
  Done("reject", {{"revision", 2}});
  SetPolicy("tolerance_mm: 50\n");
  StepAll();
  ASSERT_EQ(Newest(), 3);
  EXPECT_EQ(Announced(), 1);
  EXPECT_EQ(Ask("show")["state"], "candidate");
}

TEST_F(HeldBackTest, ARollbackIsNotUndoneByAPolicyForTheFleetButByAMeasurement) {
  SetUpTwoRevisions();
  Done("rollback", {{"revision", 1}});
  SetPolicy("tolerance_mm: 50\n");
  StepAll();
  ASSERT_EQ(Newest(), 3);
  EXPECT_EQ(Announced(), 1);
  Push(1.00005);
  EXPECT_EQ(Announced(), Newest()) << "something was measured since";
}

// By automatic approval the one before is in use again, and that is a decision like any other, in the audit before any
// revision is made.
TEST_F(HeldBackTest, WhatWasRetiredMakesWayByADecisionOfThePolicy) {
  SetUpTwoRevisions();
  Done("retire", {{"edge", once_more_.str()}, {"reason", "typed wrong"}});
  EXPECT_EQ(Announced(), 1);
  const std::vector<AuditRow> rows = storage::LoadAudit(*store_, RobotId("r")).value();
  EXPECT_EQ(rows[0].who, "policy");
  EXPECT_EQ(rows[0].what, "approved revision 1 of robot r: of revision 2, which was in use, something was retired");
  EXPECT_THAT(rows[1].what, HasSubstr("retired edge"));
  EXPECT_TRUE(Holds(storage::VerifyAudit(*store_).value()));
  EXPECT_EQ(
      store_->database().execAndGet("SELECT count(*) FROM alert WHERE kind = 'approved' AND subject = '1'").getInt(), 2)
      << "receivers are told that the robot is to use revision 1 again";
}

TEST_F(HeldBackTest, WherePeopleApproveWhatWasRetiredLeavesNothingInUse) {
  SetUpTwoRevisions();
  SetPolicy("approval: person");
  StepAll();
  const std::size_t rows = storage::LoadAudit(*store_, RobotId("r"))->size();
  Done("retire", {{"edge", once_more_.str()}, {"reason", "typed wrong"}});
  EXPECT_EQ(Announced(), 0) << "nobody decided that revision 1 is in use again";
  EXPECT_EQ(storage::LoadAudit(*store_, RobotId("r"))->size(), rows + 1);
  EXPECT_TRUE(Ask("show")["usable"].is_null());
  const json revisions = Ask("revisions")["revisions"];
  EXPECT_EQ(revisions[1]["revision"], 2);
  EXPECT_EQ(revisions[1]["state"], "taken_back");
}

// Also of the newest revision, before the next one is made.
TEST_F(HeldBackTest, WhatWasJustRetiredCannotBeApproved) {
  SetPolicy("approval: person");
  Push(1.0);
  std::vector<Edge> wrong = {GivenEdge("r", "a", "b", 1.0001)};
  AssignPushedIds(wrong);
  StoreEdges(wrong);
  StepAll();
  ASSERT_EQ(Newest(), 2);
  Done("retire", {{"edge", wrong.front().id.str()}, {"reason", "typed wrong"}});
  const auto refused = Order("approve", {{"revision", 2}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("cannot be used: what it was made of was retired"));
  EXPECT_EQ(Announced(), 0);
}

// A revision is never lost for the audit's sake; but nothing is put in use that the audit could not tell of.
TEST_F(HeldBackTest, WithADamagedAuditRevisionsAreMadeAndWait) {
  SetUpTwoRevisions();
  store_->database().exec("INSERT INTO audit VALUES (9223372036854775807, 1, 'x', 'y')");
  Push(1.00005);
  ASSERT_EQ(Newest(), 3) << "it is made all the same";
  EXPECT_EQ(Announced(), 2);
  EXPECT_EQ(Ask("show")["state"], "candidate");
  const auto refused = Order("approve", {{"revision", 3}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("the audit is damaged"));
  EXPECT_THAT(refused.error().cure, HasSubstr("rigcal audit verify"));
}

// What it runs is what counts for who drives.
TEST_F(HeldBackTest, ARobotThatRunsWhatWasRejectedIsNotOkToDrive) {
  SetUpTwoRevisions();
  const auto says = [&](int revision) {
    const RunsReport report{RobotId("r"), revisions_[static_cast<std::size_t>(revision - 1)].digest, clock_.now,
                            "agent"};
    ASSERT_TRUE(storage::AppendRuns(*store_, report, clock_.now));
  };
  EXPECT_EQ(Ask("show")["drive"]["kind"], "ok") << "it never told";
  says(1);
  EXPECT_EQ(Ask("show")["drive"]["rule"], "Not applied: the robot runs revision 1; revision 2 is in use");
  EXPECT_EQ(Ask("status")["robots"][0]["drive"]["kind"], "not_applied");
  EXPECT_THAT(Page(), HasSubstr("Not applied: the robot runs revision 1; revision 2 is in use."));
  says(2);
  EXPECT_EQ(Ask("show")["drive"]["kind"], "ok");
  EXPECT_EQ(Ask("show")["runs"]["digest"], revisions_[1].digest.str());
  Done("reject", {{"revision", 2}});
  EXPECT_THAT(Ask("show")["drive"]["rule"].get<std::string>(),
              HasSubstr("Not applied: the robot runs revision 2, which was rejected by Ada, "));
  EXPECT_THAT(Ask("show")["runs"]["trouble"].get<std::string>(),
              HasSubstr("It runs revision 2, which was rejected by Ada"));
}

}  // namespace
}  // namespace rigcal::pipeline

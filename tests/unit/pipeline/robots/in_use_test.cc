// What robots are told to do follows from the calibration that they have, whatever came since.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/robots/summaries.h"
#include "storage/alerts/revision_status.h"
#include "storage/fleet/robot_runs.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// "20261006", as calendars have it.
std::string DayOf(Stamp stamp) {
  std::string day = ToIso(stamp).substr(0, 10);
  std::erase(day, '-');
  return day;
}

class InUseTest : public PipelineTest {
 protected:
  json Ask(const std::string& verb, const std::string& parameters = R"({"robot":"r"})") {
    RevisionCache revisions;
    const auto answer = Answer({*store_, clock_, revisions, {}, ""}, verb, parameters);
    EXPECT_TRUE(answer) << verb << ": " << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  // Of the one robot; a list says of it what is worked out here.
  json Row() {
    json row = Ask("status")["robots"][0];
    for (const char* verb : {"due", "robots"}) {
      const json listed = Ask(verb, "{}")["robots"][0];
      for (const auto& [member, value] : listed.items()) EXPECT_EQ(value, row[member]) << verb << " " << member;
    }
    return row;
  }
  std::string Page(const std::string& query) {
    RevisionCache revisions;
    const auto page = AnswerPage({*store_, clock_, revisions, {}, ""}, "/", query);
    EXPECT_TRUE(page) << Sentence(page.error());
    return page.value_or(PageText{}).body;
  }
  void Order(const std::string& verb, json parameters) {
    parameters["who"] = "Ada";
    parameters["reason"] = "checked";
    const auto done = CarryOut(*store_, clock_, verb, parameters.dump());
    EXPECT_TRUE(done) << Sentence(done.error());
  }
  void Decide(const std::string& verb, int revision) { Order(verb, {{"robot", "r"}, {"revision", revision}}); }
  // Three sensors, measured now.
  int Push(double ab_m) {
    std::vector<Edge> edges = {GivenEdge("r", "a", "b", ab_m), GivenEdge("r", "b", "c", 1.0),
                               GivenEdge("r", "a", "c", 1.0 + ab_m)};
    for (Edge& edge : edges) edge.measured_at = clock_.now;
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
    return revisions_.back().number;
  }
  // A revision that was measured now, with the date by drift of its sensor b.
  void Keep(const DriftDue& due) {
    Revision revision;
    revision.robot = kRig;
    revision.verdict.level = VerdictLevel::kPass;
    revision.document = "{\"due\":" + std::to_string(due.at.ns) + "}";
    revision.digest = Sha256Of(revision.document);
    revision.calibrated_at = clock_.now;
    StatusFacts facts;
    facts.sensors = {{SensorId("a"), {}}, {SensorId("b"), {}, due}};
    const Status kept = store_->Write([&]() -> Status {
      RIGCAL_TRY(storage::AppendRobot(*store_, kRig, clock_.now));
      RIGCAL_ASSIGN(const int number, storage::AppendRevision(*store_, revision));
      return storage::AppendRevisionStatus(*store_, {kRig, number}, facts);
    });
    ASSERT_TRUE(kept) << Sentence(kept.error());
  }
  // One in use that was measured so many days ago, and a candidate of today; its number.
  int PushCandidateAfter(int days) {
    Order("set_policy", {{"text", "approval: person"}});
    Decide("approve", Push(1.0));
    clock_.now.ns += days * kDay_ns;
    return Push(1.00001);
  }
};

TEST_F(InUseTest, ACandidateMakesNoRobotYounger) {
  const Stamp measured = clock_.now;
  const int candidate = PushCandidateAfter(142);
  const Stamp until_at{measured.ns + kDefaultMaxAge_ns};
  const std::string until = DayText(until_at);
  for (const bool is_rejected : {false, true}) {
    const json row = Row();
    EXPECT_TRUE(row["overdue"]);
    EXPECT_EQ(row["calibrated_at"], ToIso(measured));
    EXPECT_EQ(row["due"]["text"], "due " + until + " by age");
    EXPECT_EQ(row["status"]["word"], "overdue");
    EXPECT_EQ(row["status"]["why"], "It was to be calibrated again by " + until + ".");
    EXPECT_THAT(row["status"]["next_step"], StartsWith(is_rejected ? "Capture a session" : "`rigcal approve r "));
    EXPECT_EQ(row["drive"]["rule"],
              "Not approved: robots have revision 1, measured " + DayText(measured) + ", valid until " + until);
    EXPECT_EQ(Ask("lookup", R"({"robot":"r","a":"a","b":"b"})")["overdue"], row["overdue"]);
    EXPECT_THAT(Ask("due_ics", "{}")["ics"].get<std::string>(), HasSubstr("DTSTART;VALUE=DATE:" + DayOf(until_at)));
    EXPECT_THAT(Page("status=overdue"), HasSubstr(">r</a>"));
    EXPECT_THAT(Page("verdict=later"), Not(HasSubstr(">r</a>")));
    if (!is_rejected) Decide("reject", candidate);
  }
  Decide("approve", candidate);
  EXPECT_FALSE(Row()["overdue"]);
  EXPECT_EQ(Row()["status"]["word"], "ok");
  EXPECT_EQ(Row()["calibrated_at"], ToIso(clock_.now));
}

TEST_F(InUseTest, ASensorThatOnlyANewerRevisionHasIsSaidToBeThere) {
  PushCandidateAfter(1);
  std::vector<Edge> edges = {GivenEdge("r", "a", "d", 3.0), GivenEdge("r", "b", "d", 2.0)};
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  const int candidate = revisions_.back().number;
  const auto refused = [&] {
    RevisionCache revisions;
    const auto answer = Answer({*store_, clock_, revisions, {}, ""}, "lookup", R"({"robot":"r","a":"a","b":"d"})");
    EXPECT_FALSE(answer);
    return answer ? Error{} : answer.error();
  };
  const std::string number = std::to_string(candidate),
                    only = "sensor d is not in the calibration of r that is in use (revision " +
                           std::to_string(storage::LoadInUse(*store_, kRig).value()->revision) +
                           "), only in revision " + number + ", which ";
  EXPECT_EQ(refused().code, ErrorCode::kNotFound);
  EXPECT_EQ(refused().what, only + "nobody has approved");
  EXPECT_EQ(refused().cure, "`rigcal lookup r a d --revision " + number + "` gives it.");
  EXPECT_EQ(Ask("lookup", R"({"robot":"r","a":"a","b":"d","revision":)" + number + "}")["revision"], candidate);
  Decide("reject", candidate);
  EXPECT_EQ(refused().what, only + "is rejected");
  Decide("approve", candidate);
  EXPECT_EQ(Ask("lookup", R"({"robot":"r","a":"a","b":"d"})")["revision"], candidate);
}

TEST_F(InUseTest, TheDatesByDriftAreThoseOfTheCalibrationInUse) {
  const Stamp began = clock_.now;
  const auto due_after = [&](int days) { return DriftDue{SensorId("b"), Stamp{began.ns + days * kDay_ns}}; };
  Keep(due_after(20));
  ASSERT_TRUE(storage::AppendDecision(*store_, kRig, 1, storage::Deciding::kApprove, {clock_.now, "Ada", "checked"}));
  Keep(due_after(50));
  const auto told = [&] { return LoadRobotSummary(*store_, kRig, clock_.now).value(); };
  EXPECT_EQ(told().revision, 2);
  EXPECT_EQ(told().drift_due, due_after(20));
  EXPECT_EQ(told().sensors.at(1).due, due_after(20));
  ASSERT_TRUE(storage::AppendDecision(*store_, kRig, 2, storage::Deciding::kApprove, {clock_.now, "Ada", "checked"}));
  EXPECT_EQ(told().drift_due, due_after(50));
  EXPECT_EQ(told().sensors.at(1).due, due_after(50));
}

TEST_F(InUseTest, WhatWaitsForAWordOrToBeAppliedIsWork) {
  const int candidate = PushCandidateAfter(10);
  EXPECT_EQ(Row()["status"]["word"], "to-approve");
  EXPECT_EQ(Row()["status"]["next_step"],
            "`rigcal approve r " + std::to_string(candidate) + " --reason TEXT`, if it is right.");
  EXPECT_THAT(Page("status=work"), HasSubstr(">r</a>"));
  ASSERT_TRUE(storage::AppendRuns(*store_, {kRig, storage::LoadRevision(*store_, kRig, 1).value()->digest, {}, "agent"},
                                  clock_.now));
  Decide("approve", candidate);
  EXPECT_EQ(Row()["status"]["word"], "not-applied");
  EXPECT_EQ(Row()["status"]["next_step"],
            "See to it that `rigcal agent` runs on the robot: it applies revision " + std::to_string(candidate) + ".");
  EXPECT_THAT(Page("status=work"), HasSubstr("it applies revision"));
  ASSERT_TRUE(storage::AppendRuns(
      *store_, {kRig, storage::LoadRevision(*store_, kRig, candidate).value()->digest, {}, "agent"}, clock_.now));
  EXPECT_EQ(Row()["status"]["word"], "ok");
  EXPECT_THAT(Page("status=work"), Not(HasSubstr(">r</a>")));
}

}  // namespace
}  // namespace rigcal::pipeline

// Where a revision is in its life, and who decided what, as documents have it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "server/base/digests/sha256.h"
#include "server/formats/answers/answers.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;

const RobotId kRig("rig");
const Decision kThird{7, 3, "approved", {{1'793'707'200'000'000'000}, "policy", "the verdict is \"document\":null"}};

Revision RevisionOf(int number) {
  Revision revision;
  revision.robot = kRig;
  revision.number = number;
  revision.document = R"({"reference":"left"})";
  revision.digest = Sha256Of(revision.document);
  return revision;
}

TEST(DecisionAnswers, ARevisionTellsItsStateAndWhatIsInUse) {
  const Approval candidate{RevisionState::kCandidate, {}, kThird};
  const json decided = json::parse(WriteDecided(RevisionOf(4), candidate));
  EXPECT_EQ(decided["state"], "candidate");
  EXPECT_TRUE(decided["decision"].is_null());
  EXPECT_EQ(decided["in_use"], (json{{"revision", 3},
                                     {"how", "approved"},
                                     {"at", "2026-11-03T12:00:00Z"},
                                     {"who", "policy"},
                                     {"reason", "the verdict is \"document\":null"}}));
  EXPECT_EQ(decided["revision_follows"], false);
  const json rows = json::parse(WriteRevisions(kRig, {RevisionOf(4), RevisionOf(3)}, {}, {},
                                               {candidate, {RevisionState::kApproved, kThird, kThird}}));
  EXPECT_EQ(rows["revisions"][0]["state"], "candidate");
  EXPECT_EQ(rows["revisions"][1]["decision"]["who"], "policy");
}

// Whatever people write as their reason.
TEST(DecisionAnswers, TheDocumentOfShowStandsInItsPlace) {
  const json shown = json::parse(WriteShow(RevisionOf(3), true, {}, {}, {RevisionState::kApproved, kThird, kThird}));
  EXPECT_EQ(shown["document"]["reference"], "left");
  EXPECT_EQ(shown["decision"]["reason"], "the verdict is \"document\":null");
}

TEST(AuditAnswers, RowsHeadAndFault) {
  AuditRow row{17, {1'793'707'200'000'000'000}, kRig, "Ada", "retired", Sha256Of("x")};
  row.digest = Sha256Of("document");
  const json rows = json::parse(WriteAudit({row, {16, {}, {}, "Eve", "set"}}, 16));
  EXPECT_EQ(rows["next"], 16);
  EXPECT_EQ(rows["rows"][0]["at"], "2026-11-03T12:00:00Z");
  EXPECT_EQ(rows["rows"][0]["hash"], Sha256Of("x").str());
  EXPECT_EQ(rows["rows"][0]["digest"], Sha256Of("document").str());
  EXPECT_TRUE(rows["rows"][1]["robot"].is_null() && rows["rows"][1]["hash"].is_null());
  EXPECT_TRUE(rows["rows"][1]["digest"].is_null());
  AuditCheck check{16, 16, Sha256Of("x"), {}};
  EXPECT_TRUE(json::parse(WriteAuditCheck(check))["fault"].is_null());
  check.fault = AuditFault{AuditFault::Kind::kChanged, 17, row.at};
  const json told = json::parse(WriteAuditCheck(check));
  EXPECT_EQ(told["head"], (json{{"number", 16}, {"hash", Sha256Of("x").str()}}));
  EXPECT_EQ(told["fault"]["what"], "audit row 17 of 3 Nov 2026 was changed, or one before it is missing");
  EXPECT_EQ(told["chain_holds"], false);
}

TEST(AuditAnswers, ARowThatDecidesAndDoesNotHoldIsAFaultToo) {
  AuditCheck check{16, 16, Sha256Of("x"), {}};
  check.row_faults = {
      {AuditFault::Kind::kRowUnheld, 0, {}, "decision 7 (approved revision 2 of robot rig, by policy)"}};
  check.row_faults_count = 1;
  check.from_before = 5;
  const json told = json::parse(WriteAuditCheck(check));
  EXPECT_EQ(told["chain_holds"], true);
  EXPECT_EQ(told["fault"]["what"],
            "decision 7 (approved revision 2 of robot rig, by policy) has no audit row: rigcald did not write it");
  EXPECT_TRUE(told["fault"]["number"].is_null());
  EXPECT_EQ(told["row_faults"], json::array({told["fault"]}));
  EXPECT_EQ(told["row_faults_total"], 1);
  EXPECT_EQ(told["from_before"], 5);
}

}  // namespace
}  // namespace rigcal::formats

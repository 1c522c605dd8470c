// What people are told of the audit. Against a server in memory.
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

TEST(AuditVerb, ListsRowsByPages) {
  std::string asked;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + " " + json;
    return R"({"next":8,"rows":[{"number":9,"at":"2026-11-03T12:00:00Z","robot":"r","who":"Ada","what":"retired sensor top of robot r: off","hash":"f"},)"
           R"({"number":8,"at":"2026-11-02T12:00:00Z","robot":null,"who":"E\u0007ve","what":"set a policy","hash":null}]})";
  });
  const Ran ran = Rigcal({"audit", "r", "--limit", "2"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked, R"(audit {"limit":2,"robot":"r"})");
  EXPECT_NE(ran.out.find("     9  2026-11-03T12:00:00Z  Ada   retired sensor top of robot r: off\n"), std::string::npos)
      << ran.out;
  EXPECT_NE(ran.out.find("E ve  set a policy\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("There are older ones: `rigcal audit r --limit 2 --before 8`\n"), std::string::npos)
      << ran.out;
  EXPECT_EQ(Rigcal({"audit", "--robot", "verify", "--before", "8"}).code, 0);
  EXPECT_EQ(asked, R"(audit {"limit":20,"robot":"verify","before":8})");
  EXPECT_EQ(Rigcal({"audit", "verify", "--robot", "r"}).code, 2);
  EXPECT_EQ(ran.out.find("DIGEST"), std::string::npos) << "nothing was decided about a document";
}

TEST(AuditVerb, TellsTheDigestOfWhatWasDecidedAbout) {
  FakeServer server(
      "r",
      Always(
          R"({"rows":[{"number":9,"at":"2026-11-03T12:00:00Z","who":"Ada","what":"approved revision 2 of robot r","digest":"0123456789abcdef"},)"
          R"({"number":8,"at":"2026-11-02T12:00:00Z","who":"Eve","what":"set a policy","digest":null}]})"));
  const std::string told = Rigcal({"audit"}).out;
  EXPECT_NE(told.find("9  2026-11-03T12:00:00Z  Ada  0123456789ab  approved revision 2 of robot r\n"),
            std::string::npos)
      << told;
  EXPECT_NE(told.find("8  2026-11-02T12:00:00Z  Eve                set a policy\n"), std::string::npos) << told;
}

TEST(AuditVerb, VerifyEndsWithOneWhereARowDoesNotHold) {
  std::string asked, fault = "null";
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + " " + json;
    return R"({"rows":16,"head":{"number":16,"hash":"abc"},"fault":)" + fault + "}";
  });
  Ran ran = Rigcal({"audit", "verify"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked, "audit_verify {}");
  EXPECT_NE(ran.out.find("head  16 abc\n"), std::string::npos) << ran.out;
  fault =
      R"({"number":17,"at":"2026-11-03T12:00:00Z","what":"audit row 17 of 3 Nov 2026 was changed, or one before it is missing"})";
  ran = Rigcal({"audit", "verify"});
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out.rfind("The audit does not hold: audit row 17 of 3 Nov 2026 was changed, or one before it is "
                          "missing. The 16 before it",
                          0),
            0u)
      << ran.out;
}

TEST(AuditVerb, VerifyNamesEachRowThatDecidesAndDoesNotHold) {
  std::string faults = R"({"number":null,"at":null,"what":"decision 7 has no audit row: rigcald did not write it"},)"
                       R"({"number":9,"at":null,"what":"policy 2, which audit row 9 is about, is missing"})";
  FakeServer server("r", Always(R"({"rows":16,"head":{"number":16,"hash":"abc"},"chain_holds":true,"fault":{"what":)"
                                R"("decision 7 has no audit row: rigcald did not write it"},"row_faults":[)" +
                                faults + R"(],"row_faults_total":5})"));
  const Ran ran = Rigcal({"audit", "verify"});
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out.rfind("The audit does not hold: decision 7 has no audit row: rigcald did not write it. Its 16 rows "
                          "are as they were written.",
                          0),
            0u)
      << ran.out;
  EXPECT_NE(ran.out.find("\n! policy 2, which audit row 9 is about, is missing.\n! 3 more do not hold either.\n"),
            std::string::npos)
      << ran.out;
}

TEST(AuditVerb, VerifyTellsWhatIsFromBefore) {
  FakeServer server("r", Always(R"({"rows":16,"head":{"number":16,"hash":"abc"},"fault":null,"from_before":5})"));
  const Ran ran = Rigcal({"audit", "verify"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find(
                "5 decisions, standings, policies, rig models and board measures are from before the audit held each"),
            std::string::npos)
      << ran.out;
}

TEST(AuditVerb, TakesAnEmptyDocument) {
  FakeServer server("r", Always("{}"));
  EXPECT_EQ(Rigcal({"audit"}).out, "Nobody has decided anything yet.\n");
  EXPECT_EQ(Rigcal({"audit", "verify"}).code, 0);
}

}  // namespace
}  // namespace rigcal::client

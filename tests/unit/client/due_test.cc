// What `rigcal due` says is to be done.
#include <gmock/gmock.h>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A robot of docs/api.md, calibrated at `calibrated_at`.
std::string Row(const std::string& robot, const std::string& calibrated_at, bool overdue, const std::string& word,
                const std::string& next_step) {
  return R"({"robot":")" + robot + R"(","calibrated_at":)" + calibrated_at + R"(,"age_ns":1,"overdue":)" +
         (overdue ? "true" : "false") + R"(,"verdict":{"level":"pass"},"status":{"word":")" + word +
         R"(","why":"It is so.","next_step":")" + next_step + R"("}})";
}

Ran Due(const std::string& rows) {
  const std::string document = R"({"max_age_ns":null,"now":"2026-01-31T12:00:00Z","robots":[)" + rows + "]}";
  FakeServer server("r", Always(document));
  return Rigcal({"due"});
}

const std::string kDay = R"("2026-01-30T12:00:00Z")";

TEST(Due, OfWhatIsOverdueTheNextStepIsTold) {
  const Ran ran = Due(Row("r1", kDay, true, "overdue", "Approve it. Else: Capture.") + "," +
                      Row("r2", kDay, true, "ok", "Nothing is to be done."));
  EXPECT_EQ(ran.code, 1);
  EXPECT_THAT(ran.out, HasSubstr("pass     Approve it. Else: Capture.\n"));
  EXPECT_THAT(ran.out, HasSubstr("pass     Capture a session and push it.\n")) << "by the age that was asked for alone";
}

TEST(Due, WhatIsNotCalibratedIsNotCalledOverdue) {
  const std::string row = Row("r1", "null", true, "unknown", "Push a capture session or finished edges.");
  const Ran alone = Due(row);
  EXPECT_EQ(alone.code, 1);
  EXPECT_THAT(alone.out, HasSubstr("No robot is overdue: 1 known; those that are calibrated are so within the time"));
  EXPECT_THAT(alone.out, HasSubstr("NOT CALIBRATED  VERDICT  NEXT STEP"));
  EXPECT_THAT(alone.out, HasSubstr("Push a capture session or finished edges.\n"));
  EXPECT_THAT(alone.out, Not(HasSubstr("ALSO"))) << "once is enough";
  const Ran both = Due(row + "," + Row("r2", kDay, true, "overdue", "Capture."));
  EXPECT_THAT(both.out, AllOf(HasSubstr("OVERDUE  CALIBRATED"), HasSubstr("NOT CALIBRATED  VERDICT")));
}

TEST(Due, WhatWaitsForSomebodyIsListedWhateverItsDate) {
  const Ran ran = Due(Row("r1", kDay, false, "to-approve", "Approve it.") + "," +
                      Row("r2", kDay, false, "not-applied", "Apply it.") + "," + Row("r3", kDay, false, "ok", "-"));
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.out, HasSubstr("to-approve   Approve it."));
  EXPECT_THAT(ran.out, HasSubstr("not-applied  Apply it."));
  EXPECT_THAT(ran.out, Not(HasSubstr("r3")));
}

TEST(Due, OfASiteTheServerIsAskedAndPeopleAreTold) {
  std::string asked;
  bool overdue = false;
  FakeServer server("r", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return R"({"max_age_ns":null,"robots":[)" + Row("r1", kDay, overdue, overdue ? "overdue" : "ok", "Capture.") + "]}";
  });
  const Ran ran = Rigcal({"due", "--site", "hall \"3\""});
  EXPECT_EQ(asked, R"({"site":"hall \"3\""})");
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.out, HasSubstr("No robot is overdue: 1 known at hall \"3\", all calibrated"));
  overdue = true;
  EXPECT_EQ(Rigcal({"due", "--site", "hall 3", "--max-age", "30d"}).code, 1);
  EXPECT_EQ(asked, R"({"max_age_ns":2592000000000000,"site":"hall 3"})");
}

}  // namespace
}  // namespace rigcal::client

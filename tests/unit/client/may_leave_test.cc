// Which revision leaves, and by which words it is refused.
#include "client/exchange/may_leave.h"

#include <gmock/gmock.h>

namespace rigcal::client {
namespace {

using testing::HasSubstr;
using testing::Not;

Document Shown(const std::string& state, const std::string& level, const std::string& more = "") {
  return *Document::Parse(R"({"robot":"rig","revision":4,"usable":{"revision":3},"state":")" + state +
                              R"(","document":{"verdict":{"level":")" + level +
                              R"(","why":"two edges disagree","what_to_do":"look at b"}})" + more + "}",
                          "test");
}

TEST(MayLeave, WhatIsInUseDoes) {
  const auto leave = MayLeave(Shown("approved", "pass"), false);
  ASSERT_TRUE(leave);
  EXPECT_EQ(leave->standing, "in use");
  EXPECT_EQ(leave->doubt, "");
  const auto overdue = MayLeave(
      Shown("approved", "pass", R"(,"overdue":true,"drive":{"rule":"Not verified: do not rely on it"})"), false);
  EXPECT_THAT(overdue->doubt, HasSubstr("Not verified: do not rely on it."));
}

TEST(MayLeave, WhatNobodyApprovedIsRefusedWithTheCommandThatDoes) {
  const auto leave = MayLeave(Shown("candidate", "pass"), false);
  ASSERT_FALSE(leave);
  EXPECT_EQ(leave.error().code, ErrorCode::kConflict);
  EXPECT_THAT(leave.error().what, HasSubstr("revision 4 of rig is not approved: it is candidate"));
  EXPECT_THAT(leave.error().cure,
              HasSubstr("`rigcal approve rig 4 --reason TEXT` approves it. --even-if-not-approved"));
  EXPECT_EQ(MayLeave(Shown("candidate", "pass"), false, false).error().cure,
            "`rigcal approve rig 4 --reason TEXT` approves it.");
  const auto forced = MayLeave(Shown("candidate", "pass"), true);
  EXPECT_EQ(forced->standing, "candidate, not approved");
  EXPECT_THAT(forced->doubt, HasSubstr("is not approved"));
}

TEST(MayLeave, WhatFailedOrIsUnknownCannotBeApproved) {
  for (const auto* level : {"fail", "unknown"}) {
    const auto leave = MayLeave(Shown("unusable", level), false);
    ASSERT_FALSE(leave);
    EXPECT_THAT(leave.error().what, HasSubstr("has the verdict " + std::string(level) + ": two edges disagree"));
    EXPECT_THAT(leave.error().cure, Not(HasSubstr("rigcal approve")));
    EXPECT_EQ(MayLeave(Shown("unusable", level), true)->standing, std::string(level) + ", not approved");
  }
}

TEST(MayLeave, OlderOnesOnlyIfTheyWereApprovedAndNotTakenBack) {
  EXPECT_THAT(MayLeave(Shown("superseded", "pass"), false)->doubt, HasSubstr("not the one that is in use"));
  EXPECT_FALSE(MayLeave(Shown("rolled_back", "pass"), false));
  EXPECT_FALSE(MayLeave(Shown("rejected", "pass"), false));
}

TEST(MayLeave, AServerThatKnowsNoApprovalsGoesByTheVerdict) {
  const auto shown = [](const std::string& level) {
    return *Document::Parse(R"({"revision":2,"document":{"verdict":{"level":")" + level + R"("}}})", "test");
  };
  EXPECT_TRUE(MayLeave(shown("warn"), false));
  EXPECT_FALSE(MayLeave(shown("fail"), false));
  EXPECT_EQ(RevisionInUse(shown("warn")), 2);
  EXPECT_EQ(RevisionInUse(Shown("candidate", "pass")), 3);
}

}  // namespace
}  // namespace rigcal::client

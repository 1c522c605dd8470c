#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/robot_pages.h"
#include "tests/unit/report_sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kDay_ns = 86'400LL * 1'000'000'000;

FleetRow RowOf(const std::string& robot, VerdictLevel level, int revision) {
  return {RobotId(robot), revision, {level, "because of " + robot, ""}, Stamp{100 * kDay_ns}, 2, 5, false};
}

TEST(ReportFleet, EmptyFleetTellsHowToPush) {
  const std::string page = RenderFleet({}, Stamp{0}).value();
  EXPECT_THAT(page, HasSubstr("rigcal push"));
  EXPECT_THAT(page, Not(HasSubstr("<table")));
}

TEST(ReportFleet, WorstFirstWithAgeAndLinks) {
  FleetRow late = RowOf("late", VerdictLevel::kPass, 4);
  late.overdue = true;
  const std::string page =
      RenderFleet({RowOf("good", VerdictLevel::kPass, 1), late, RowOf("bad", VerdictLevel::kFail, 2)},
                  Stamp{103 * kDay_ns})
          .value();
  EXPECT_LT(page.find("because of bad"), page.find("because of late"));
  EXPECT_LT(page.find("because of late"), page.find("because of good"));
  EXPECT_THAT(page, HasSubstr("href=\"robots/late/revisions/4/\""));
  EXPECT_THAT(page, HasSubstr("href=\"robots/bad/\""));
  EXPECT_THAT(page, HasSubstr(AgeText(3 * kDay_ns) + " ago"));
  EXPECT_THAT(page, HasSubstr("3 robots: 1 fail, 2 pass; 1 overdue"));
}

TEST(ReportFleet, RobotWithoutRevisionHasNoAge) {
  const std::string page = RenderFleet({RowOf("new", VerdictLevel::kUnknown, 0)}, Stamp{0}).value();
  EXPECT_THAT(page, HasSubstr("never"));
  EXPECT_THAT(page, Not(HasSubstr("revisions/")));
}

TEST(ReportFleet, ClockThatWentBackIsNamed) {
  EXPECT_THAT(RenderFleet({RowOf("a", VerdictLevel::kPass, 1)}, Stamp{0}).value(), HasSubstr("check the clock"));
}

TEST(ReportRobot, RevisionsNewestFirst) {
  std::vector<Revision> revisions(3);
  for (int i = 0; i < 3; ++i) {
    auto& revision = revisions[static_cast<std::size_t>(i)];
    revision.number = i + 1;
    revision.digest = Sha256Of(std::to_string(i + 1));
    revision.verdict.level = VerdictLevel::kPass;
  }
  const std::string page =
      RenderRobot({RowOf("mapper", VerdictLevel::kPass, 3), revisions, {}, {}}, Stamp{101 * kDay_ns}).value();
  EXPECT_LT(page.find("revisions/3/"), page.find("revisions/2/"));
  EXPECT_LT(page.find("revisions/2/"), page.find("revisions/1/"));
  EXPECT_THAT(page, HasSubstr(Sha256Of("3").str().substr(0, 12)));
  EXPECT_THAT(page, HasSubstr("href=\"../../style.css\""));
  EXPECT_THAT(page, HasSubstr("banner pass"));
}

}  // namespace
}  // namespace rigcal::report

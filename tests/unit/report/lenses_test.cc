// What the comparison of two revisions says and draws of lenses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/robot_pages.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// 1200 x 900; 0.1 px to the right everywhere, but for the lower right, where no corners were seen.
LensChange Change(const std::string& camera, double corner_px) {
  LensChange change;
  change.camera = SensorId(camera);
  change.width_px = 1200, change.height_px = 900;
  change.columns = 12, change.rows = 9;
  change.shift_px.assign(108, Eigen::Vector2d(0.1, 0.0));
  change.shift_px[107] = Eigen::Vector2d(0.0, corner_px);
  change.seen.assign(108, true);
  change.seen[107] = false;
  change.turn_rad = 0.001;
  return change;
}

std::string LensPageOf(const ComparedLenses& lenses) {
  const auto revision = std::make_shared<const formats::RevisionInput>(SampleReport().revision);
  CompareInput input{RobotId("r"), {1, revision}, {2, revision}, 2};
  input.lenses = lenses;
  return RenderCompare(input).value();
}

TEST(ComparedLensesPage, TellsTheWorstTheMiddleAndWhatWasTakenOut) {
  const std::string page = LensPageOf({{Change("front", 0.8)}, {}, {}});
  EXPECT_THAT(
      page,
      HasSubstr("<strong>front</strong> at most 0.80 px (at the lower right), 0.10 px in the middle; where both saw "
                "corners, at most 0.10 px; a turn by 0.057 deg is taken out"));
  EXPECT_THAT(
      page,
      HasSubstr("role=\"img\" aria-label=\"How far a point far away is projected from where it was, by fields of the "
                "picture of front: at most 0.80 px"));
  EXPECT_THAT(page, HasSubstr("<path class=\"unseen\" d=\"M11 8m0 1l1-1\"/>"));
  // The longest is 0.24 units: 100 times, 24.
  EXPECT_THAT(page, HasSubstr("M345.0 255.0l0.0 24.0\""));
}

TEST(ComparedLensesPage, TheFarthestOffComesFirst) {
  const std::string page = LensPageOf({{Change("a", 0.2), Change("b", 0.9), Change("c", 0.5)}, {}, {}});
  EXPECT_LT(page.find("<strong>b</strong>"), page.find("<strong>c</strong>"));
  EXPECT_LT(page.find("<strong>c</strong>"), page.find("<strong>a</strong>"));
}

TEST(ComparedLensesPage, OthersAreNamed) {
  const std::string page = LensPageOf(
      {{}, {SensorId("left"), SensorId("right")}, {{SensorId("rear"), "nothing was kept of it in revision 1"}}});
  EXPECT_THAT(page, HasSubstr("The same intrinsics in both: <bdi>left, right</bdi>."));
  EXPECT_THAT(page, HasSubstr("<bdi>rear</bdi> is not compared: nothing was kept of it in revision 1."));
  EXPECT_THAT(page, Not(HasSubstr("taken out")));
  EXPECT_THAT(LensPageOf({}), Not(HasSubstr("id=\"lenses\"")));
}

TEST(ComparedLensesPage, NothingOddBecomesANumber) {
  LensChange blank = Change("front", 0.0);
  blank.shift_px.assign(108, std::nullopt);
  const std::string page = LensPageOf({{blank}, {}, {}});
  EXPECT_THAT(page, HasSubstr("<strong>front</strong> no ray of the one lens is one of the other"));
  EXPECT_THAT(page, HasSubstr("blank: no ray"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(ComparedLensesPage, ManyMapsStaySmall) {
  ComparedLenses lenses;
  for (int i = 0; i < 40; ++i) {
    lenses.changes.push_back(Change("camera-" + std::to_string(i), 5.0));
    for (std::size_t field = 0; field < 108; ++field)
      lenses.changes.back().shift_px[field] = Eigen::Vector2d(-1.234, 0.01 * double(field));
  }
  const std::string page = LensPageOf(lenses);
  EXPECT_THAT(page, HasSubstr("16 cameras more changed by less than these."));
  EXPECT_LT(page.size() - LensPageOf({}).size(), 24U * 20'000U);
}

}  // namespace
}  // namespace rigcal::report

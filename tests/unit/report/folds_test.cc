// What the titles of closed folds say of what is in them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The sample's good edge along a plane has a note.
TEST(ReportFolds, SayHowManyWarningsAreInThemAndHowBad) {
  ReportInput input = SampleReport();
  Edge& warned = input.revision.edges[0];
  warned.diagnoses = {{"few_captures", "Only 8 captures.", "Take more."}, {"no_tilt", "Little tilt.", "Tilt it."}};
  warned.captures[2].rms = 0.94;
  warned.captures[4].rms = 7.0;  // it was not used
  const std::string page = PageOf(input), title = Between(page, "front_left &rarr; front_right</h2>", "</summary>");
  EXPECT_THAT(title, HasSubstr("<span class=\"badge warn\">2 warnings</span>"));
  EXPECT_THAT(title, HasSubstr("worst capture 0.94 px"));
  EXPECT_THAT(Between(page, "front_right &rarr; top</h2>", "</summary>"), HasSubstr(">1 warning</span>"));
  EXPECT_THAT(Between(page, "front_left &rarr; rear</h2>", "</summary>"), Not(HasSubstr("warning"))) << "it failed";
}

TEST(ReportFolds, OfMetricMethodsAreInMillimetres) {
  ReportInput input = SampleReport();
  Edge& warned = input.revision.edges[0];
  warned.method = "lidar_camera";
  warned.diagnoses = {{"few_captures", "Only 8 captures.", "Take more."}};
  for (CaptureResidual& capture : warned.captures) capture.rms = 0.0042;
  EXPECT_THAT(PageOf(input), HasSubstr("worst capture 4.2 mm"));
}

TEST(ReportFolds, WithoutWarningsSayNothingOfThem) {
  ReportInput input = SampleReport();
  for (Edge& edge : input.revision.edges)
    if (edge.state == EdgeState::kGood) edge.diagnoses.clear();
  EXPECT_THAT(PageOf(input), Not(testing::ContainsRegex("[0-9] warnings?<")));
}

CameraReport OneCamera(const ReportInput& input) {
  CameraFit fit;
  fit.camera = SensorId("front_left");
  fit.width_px = 1200, fit.height_px = 900;
  fit.source = IntrinsicsSource::kEstimated;
  fit.intrinsics = {600.0, 600.0, 600.0, 450.0};
  fit.views.push_back({CaptureId("01"), {{300.0, 20.0}, {1100.0, 880.0}}, {{0.1, 0.0}, {0.0, 0.1}}, 1.2, {0.1, 0.0}});
  return {fit, input.revision.edges[0].id, Sha256Of("fit")};
}

TEST(ReportFolds, OfCamerasSayWhatIsWrongInFigures) {
  ReportInput input = SampleReport();
  input.cameras = {OneCamera(input)};
  const std::string page = PageOf(input), title = Between(page, "<details class=\"card edge camera\"", "</summary>");
  EXPECT_THAT(title, HasSubstr("<span class=\"badge warn\">3 warnings</span>"));
  EXPECT_THAT(title, HasSubstr("empty: left (25 %), tilt up to 6 deg, distances 1.2 to 1.2 m"));
  EXPECT_THAT(page, HasSubstr("hold the board there, too.</p>"));
}

}  // namespace
}  // namespace rigcal::report

// From the documents of cameras in the store to the maps of the pages.
#include <gmock/gmock.h>

#include "server/model/sensors/coverage.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/edges/camera_fits.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LensPagesTest : public PipelineTest {
 protected:
  static CameraFit Fit(const std::string& camera, double focal_px, int width_px = 640) {
    CameraFit fit;
    fit.camera = SensorId(camera);
    fit.width_px = width_px, fit.height_px = 480;
    fit.source = IntrinsicsSource::kEstimated;
    fit.intrinsics = {focal_px, focal_px, 319.5, 239.5};
    fit.sigma.assign(9, 0.0);
    fit.sigma[0] = 0.5;
    fit.covariance = Eigen::MatrixXd::Zero(9, 9);
    fit.covariance(0, 0) = 0.25;
    fit.implied_motion = Eigen::MatrixXd::Zero(6, 9);
    ViewFit view;
    view.capture = CaptureId("01");
    for (int row = 0; row < 9; ++row)
      for (int column = 0; column < 12; ++column)
        view.uv_px.emplace_back(MiddleOf(column, 640, 12), MiddleOf(row, 480, 9));
    fit.views = {view};
    return fit;
  }

  // A revision with an edge that carries these, of more captures than any before: the one that speaks for its cameras.
  void Revise(const std::vector<CameraFit>& fits) {
    std::vector<Edge> edges = Triangle("r");
    for (Edge& edge : edges) edge.T_a_b.p_m.z() += 1e-6 * ++pushed_;
    for (int i = 0; i < pushed_; ++i) edges[0].captures.push_back({CaptureId(std::to_string(i)), 0.1, true, ""});
    ASSERT_TRUE(AppendFits(*store_, fits, edges[0]));
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
  }
  std::string Page(const std::string& path, const std::string& query = "") {
    const auto page = AnswerPage({*store_, clock_, cache_, clock_.now, ""}, path, query);
    return page ? page->body : Sentence(page.error());
  }

  RevisionCache cache_;
  int pushed_ = 0;
};

// Of the focal length alone: half a pixel in 600 at the middle of the outermost field is 0.5 * 293.3 / 600 px to the
// side.
TEST_F(LensPagesTest, CertaintyIsWorkedOutFromTheCovariance) {
  Revise({Fit("a", 600.0)});
  std::stringstream page;
  page << std::ifstream(store_->ReportFolder() / "r" / "1" / "index.html").rdbuf();
  EXPECT_THAT(page.str(),
              HasSubstr("<strong>A point far away</strong> below 0.001 px in the middle, at most 0.24 px (at the "));
}

// All were seen: the middle of the outermost field is 293.3 by 213.3 px from the picture's, 1 % of that is 3.6 px.
TEST_F(LensPagesTest, LensesOfTwoRevisionsAreCompared) {
  Revise({Fit("a", 600.0), Fit("b", 600.0), Fit("c", 600.0, 640)});
  Revise({Fit("a", 606.0), Fit("b", 600.0), Fit("c", 600.0, 800)});
  const std::string page = Page("/robots/r/compare", "a=1&b=2");
  EXPECT_THAT(page, HasSubstr("<strong>a</strong> at most 3.6 px (at the "));
  EXPECT_THAT(page, HasSubstr("The same intrinsics in both: <bdi>b</bdi>."));
  EXPECT_THAT(page, HasSubstr("<bdi>c</bdi> is not compared: its pictures are of another size."));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace rigcal::pipeline

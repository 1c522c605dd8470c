// Pages of the whole fleet: what each robot's row knows, the experiments, and what is kept of cameras.
#include "server/formats/edges/camera_fit.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/pages/experiments.h"
#include "server/pipeline/robots/summaries.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;

class FleetPageTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  AnswerContext Context() { return {*store_, clock_, revisions_cache_, clock_.now, ""}; }
  Result<PageText> Page(const std::string& path) { return AnswerPage(Context(), path, ""); }
  void Put(const std::string& path, const std::string& text) const {
    const fs::path file = fs::path(folder_) / "experiments" / path;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
  }
};

TEST_F(FleetPageTest, RowKnowsTheWorstEdgeOfTheNewestRevision) {
  StoreEdges(Triangle("r"));
  StepAll();
  const auto summary = LoadRobotSummary(*store_, RobotId("r"), clock_.now);
  ASSERT_TRUE(summary) << Sentence(summary.error());
  ASSERT_TRUE(summary->worst);
  const auto page = Page("/");
  ASSERT_TRUE(page) << Sentence(page.error());
  EXPECT_NE(page->body.find(summary->worst->frame_a.str() + " &rarr; " + summary->worst->frame_b.str()),
            std::string::npos);
  EXPECT_FALSE(summary->last_session_at);
}

TEST_F(FleetPageTest, RowKnowsTheNewestClosedSession) {
  StoreSession("r", {{"left/1.png", "no picture"}});
  const auto summary = LoadRobotSummary(*store_, RobotId("r"), clock_.now);
  ASSERT_TRUE(summary) << Sentence(summary.error());
  EXPECT_EQ(summary->last_session_at, clock_.now);
  EXPECT_NE(Page("/")->body.find(">0 s ago"), std::string::npos);
}

// It came whole: pushing it again would change nothing.
TEST_F(FleetPageTest, ASessionWithoutAPairIsNotWaitedFor) {
  Manifest manifest;
  manifest.header.robot = RobotId("r");
  manifest.header.reference = SensorId("left");
  manifest.header.captured_at = clock_.now;
  Sensor sensor;
  sensor.id = SensorId("left");
  sensor.sees = TargetId("board");
  manifest.header.sensors = {sensor};
  Target board;
  board.id = TargetId("board");
  board.cols = 9, board.rows = 6, board.square_m = 0.025;
  manifest.header.targets = {board};
  manifest.payloads = {{"left/01.png", sensor.id, CaptureId("01"), *storage::AppendBlob(store_->BlobFolder(), "x"), 1}};
  const SessionId session = Close(manifest);
  StepAll();
  for (const std::string path : {"/", "/robots/r/"}) {
    const std::string page = Page(path).value_or(PageText{}).body;
    EXPECT_NE(page.find("has two sensors that can be calibrated against each other"), std::string::npos) << page;
    EXPECT_EQ(page.find("broke off"), std::string::npos);
  }
  const std::string page = Page("/robots/r/sessions/" + session.str() + "/").value_or(PageText{}).body;
  EXPECT_NE(page.find("Nothing: it has no pair of sensors to calibrate."), std::string::npos);
}

TEST_F(FleetPageTest, SessionSaysWhyItsPicturesCouldNotBeRead) {
  const SessionId session = StoreSession("r", {{"left/1.png", "no picture"}, {"right/1.jpg", "\xFF\xD8\xFF"}});
  const std::string path = "/robots/r/sessions/" + session.str() + "/";
  EXPECT_NE(Page(path)->body.find("not looked at yet"), std::string::npos);
  EXPECT_NE(Page("/")->body.find("The first session is being calibrated."), std::string::npos);
  StepAll();
  const auto page = Page(path);
  ASSERT_TRUE(page) << Sentence(page.error());
  for (const char* text : {"The pair of sensors could not be calibrated. 2 pictures of left, right cannot be read.",
                           "the picture is neither PNG nor JPEG", "header is cut off"})
    EXPECT_NE(page->body.find(text), std::string::npos) << text;
  EXPECT_NE(Page("/robots/r/")->body.find("0 of 1 pair good <span class=\"badge fail\">1 failed</span>"),
            std::string::npos);
}

TEST_F(FleetPageTest, SessionOfManyUnreadablePicturesSaysThatThereMayBeMore) {
  std::map<std::string, std::string> files;
  for (int k = 0; k < 30; ++k)
    for (const char* sensor : {"left/", "right/"}) files[sensor + std::to_string(k) + ".png"] = "no picture";
  const SessionId session = StoreSession("r", files);
  StepAll();
  const std::string page = Page("/robots/r/sessions/" + session.str() + "/").value_or(PageText{}).body;
  EXPECT_NE(page.find(" At least 48 pictures of left, right cannot be read."), std::string::npos) << page;
}

TEST_F(FleetPageTest, ExperimentsAreServedFromTheirFolders) {
  EXPECT_TRUE(ListExperiments(folder_).empty());
  EXPECT_NE(Page("/experiments/")->body.find("No experiment is here yet"), std::string::npos);
  Put("noise_whitening/index.html", "<!doctype html>page");
  Put("titled/index.html", "<!doctype html><title> The paper's\n experiments </title>page");
  Put("odd/index.html", "<!doctype html><title>a &amp; <b></title>page");
  Put("noise_whitening/experiment.json", "{}");
  Put("noise_whitening/plot.svg", "<svg/>");
  Put("empty/notes.txt", "no page");
  const auto list = Page("/experiments/");
  ASSERT_TRUE(list) << Sentence(list.error());
  EXPECT_NE(list->body.find("href=\"noise_whitening/\"><bdi>Noise whitening</bdi>"), std::string::npos);
  EXPECT_NE(list->body.find("<bdi>The paper&#39;s experiments</bdi>"), std::string::npos);
  EXPECT_NE(list->body.find("<bdi>Odd</bdi>"), std::string::npos);
  EXPECT_EQ(list->body.find("empty"), std::string::npos);
  EXPECT_EQ(Page("/experiments/noise_whitening/")->body, "<!doctype html>page");
  EXPECT_EQ(Page("/experiments/noise_whitening/experiment.json")->content_type, "application/json; charset=utf-8");
  EXPECT_EQ(Page("/experiments/noise_whitening/plot.svg")->content_type, "image/svg+xml");
}

TEST_F(FleetPageTest, NothingOutsideAnExperimentIsServed) {
  Put("good/index.html", "page");
  Put("good/notes.txt", "of an unknown kind");
  Put("good/.hidden.json", "{}");
  Put("good/deep/inner.json", "{}");
  fs::create_symlink(fs::path(folder_) / "rigcal.db", fs::path(folder_) / "experiments" / "good" / "link.json");
  fs::create_directory_symlink(fs::path(folder_), fs::path(folder_) / "experiments" / "up");
  std::ofstream(fs::path(folder_) / "index.html") << "not an experiment";
  for (const char* rest :
       {"../rigcal.db", "good/../../rigcal.db", "good/../good/index.html", "good/notes.txt", "good/.hidden.json",
        "good/deep/inner.json", "good/link.json", "up/", "up/index.html", "good", "good//", "..", "../", "none/"})
    EXPECT_EQ(AnswerExperiments(Context(), rest).error().code, ErrorCode::kNotFound) << rest;
  EXPECT_EQ(ListExperiments(folder_).size(), 1U);
}

CameraFit SmallFit() {
  CameraFit fit;
  fit.camera = SensorId("a");
  fit.width_px = 640, fit.height_px = 480;
  fit.views.push_back({CaptureId("01"), {{10.0, 20.0}}, {}, 0.0, {0.0, 0.0}});
  return fit;
}

TEST_F(FleetPageTest, FitsOfCamerasAreKeptShownAndMayBeGone) {
  std::vector<Edge> edges = Triangle("r");
  ASSERT_TRUE(AppendFits(*store_, {SmallFit(), CameraFit{}}, edges[0]));
  ASSERT_EQ(edges[0].evidence.size(), 1U) << "a camera that saw nothing has no document";
  StoreEdges(edges);
  StepAll();
  const Digest document = edges[0].evidence[0].digest;
  const fs::path folder = store_->ReportFolder() / "r" / "1";
  EXPECT_TRUE(fs::exists(folder / "cameras" / (document.str() + ".json")));
  EXPECT_FALSE(fs::exists(folder / "evidence" / (document.str() + ".fit")));
  std::stringstream page;
  page << std::ifstream(folder / "index.html").rdbuf();
  EXPECT_NE(page.str().find("id=\"cameras\""), std::string::npos);
  const std::vector<report::FitChoice> choices = {{SensorId("a"), edges[0].id, document},
                                                  {SensorId("b"), edges[0].id, document},
                                                  {SensorId("c"), edges[0].id, Sha256Of("gone")}};
  EXPECT_EQ(LoadFits(*store_, choices).value().size(), 1U) << "of another camera, and gone";
}

// The picture of a real pair from the store to the page.
TEST_F(FleetPageTest, ResidualsOfRealPicturesReachThePage) {
  RIGCAL_SKIP_WITHOUT_STEREO_PAIRS();
  const auto pictures = RealPictures();
  StoreSession("r", pictures);
  StepAll();
  std::stringstream page;
  page << std::ifstream(store_->ReportFolder() / "r" / "1" / "index.html").rdbuf();
  for (const char* part :
       {"class=\"usual\"", "class=\"normal\"", "class=\"compass\"", "refined with all sensors", "A point 2 m away"})
    EXPECT_NE(page.str().find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace rigcal::pipeline

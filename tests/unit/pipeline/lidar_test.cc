#include <cstring>

#include "tests/unit/calib/virtual_room.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

std::string Kitti(const std::vector<Eigen::Vector3f>& points_m) {
  std::string bytes(points_m.size() * 16, '\0');
  for (std::size_t i = 0; i < points_m.size(); ++i) std::memcpy(&bytes[16 * i], points_m[i].data(), 12);
  return bytes;
}

class LidarPipelineTest : public PipelineTest {
 protected:
  void AddFile(const SensorId& sensor, const CaptureId& capture, const std::string& bytes, Manifest& manifest) {
    Payload payload;
    payload.path = sensor.str() + "/" + capture.str() + ".bin";
    payload.sensor = sensor;
    payload.capture = capture;
    payload.digest = *storage::AppendBlob(store_->BlobFolder(), bytes);
    payload.size_bytes = static_cast<std::int64_t>(bytes.size());
    manifest.payloads.push_back(payload);
  }

  SessionId StoreRoom(const calib::LidarLidarProblem& problem, bool with_nominal,
                      LidarPolish polish = LidarPolish::kNone) {
    Manifest manifest;
    manifest.header.lidar_polish = polish;
    manifest.header.robot = RobotId("r");
    manifest.header.reference = problem.lidar_a.id;
    manifest.header.captured_at = clock_.now;
    Target board;
    board.id = TargetId("board");
    board.cols = 9, board.rows = 6, board.square_m = 0.025;
    manifest.header.targets = {board};
    manifest.header.sensors = {problem.lidar_a, problem.lidar_b};
    for (Sensor& lidar : manifest.header.sensors) lidar.layout = KittiLayout();
    if (with_nominal) {
      manifest.header.sensors[0].T_ref_nominal = Se3();
      manifest.header.sensors[1].T_ref_nominal = problem.T_a_b_nominal;
    }
    for (const auto& capture : problem.captures)
      AddFile(problem.lidar_a.id, capture.capture, Kitti(capture.a_m), manifest);
    for (const auto& capture : problem.captures)
      AddFile(problem.lidar_b.id, capture.capture, Kitti(capture.b_m), manifest);
    return Close(manifest);
  }

  Edge OnlyEdge() {
    const auto edges = storage::LoadEdges(*store_, RobotId("r"), true);
    EXPECT_TRUE(edges && edges->size() == 1);
    return edges && !edges->empty() ? edges->front() : Edge{};
  }
};

TEST_F(LidarPipelineTest, TwoCloudsGiveAnEdgeARevisionAndAReport) {
  const calib::VirtualRoom room;
  const calib::LidarLidarProblem problem = calib::RecordedIn(room, 1, 41);
  StoreRoom(problem, true);
  EXPECT_EQ(StepAll(), 3);  // job, revise, publish
  const Edge edge = OnlyEdge();
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses[0].what;
  EXPECT_EQ(edge.method, "lidar_lidar");
  const Vector6d error = (room.T_a_b.Inverse() * edge.T_a_b).Log();
  EXPECT_LT(error.head<3>().norm(), 0.01);
  EXPECT_LT(error.tail<3>().norm(), 0.005);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kModel);
  ASSERT_EQ(poses_.size(), 2u);
  EXPECT_TRUE(poses_[1].known);
  EXPECT_TRUE(std::filesystem::exists(store_->ReportFolder() / "r" / "1" / "index.html"));
  ASSERT_EQ(edge.evidence.size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(store_->ReportFolder() / "r" / "1" / "evidence" /
                                      (edge.evidence[0].digest.str() + ".jpg")));
  // What is stored is what the estimator says of the same clouds.
  EXPECT_EQ(edge.T_a_b.p_m, calib::EstimateLidarLidarEdge(problem).T_a_b.p_m);
}

// The same clouds with and without: another session, which supersedes the first; the polished pose is marked wherever
// it is shown.
TEST_F(LidarPipelineTest, ASessionThatAsksForThePolishGetsIt) {
  calib::LidarLidarProblem problem = calib::RecordedIn(calib::VirtualRoom(), 1, 41);
  const SessionId plain = StoreRoom(problem, true);
  StepAll();
  const Edge ndt = OnlyEdge();
  const SessionId asked = StoreRoom(problem, true, LidarPolish::kGicp);
  EXPECT_NE(asked, plain);
  StepAll();
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), true);
  ASSERT_TRUE(edges);
  ASSERT_EQ(edges->size(), 2u);
  const Edge& polished = edges->front().session == asked ? edges->front() : edges->back();
  ASSERT_EQ(polished.state, EdgeState::kGood) << polished.diagnoses[0].what;
  EXPECT_EQ(ndt.figures.at("polished_ratio"), 0);
  EXPECT_EQ(ndt.T_a_b.p_m, calib::EstimateLidarLidarEdge(problem).T_a_b.p_m);
  problem.polish = true;
  EXPECT_EQ(polished.figures.at("polished_ratio"), 1);
  EXPECT_EQ(polished.T_a_b.p_m, calib::EstimateLidarLidarEdge(problem).T_a_b.p_m);
  EXPECT_NE(polished.T_a_b.p_m, ndt.T_a_b.p_m);
  const auto text = [&](const char* revision) {
    std::stringstream page;
    page << std::ifstream(store_->ReportFolder() / "r" / revision / "index.html").rdbuf();
    return page.str();
  };
  EXPECT_EQ(text("1").find("polished by GICP"), std::string::npos);
  EXPECT_NE(text("2").find("lidar-lidar, polished by GICP"), std::string::npos);
  EXPECT_NE(text("2").find("polished from there by generalised ICP (GICP)"), std::string::npos);
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(revisions_[0].document.find("\"code\":\"polished\""), std::string::npos);
  EXPECT_NE(revisions_[1].document.find("\"code\":\"polished\""), std::string::npos);
  EXPECT_NE(revisions_[1].document.find("\"code\":\"superseded\""), std::string::npos);
}

TEST_F(LidarPipelineTest, WithoutNominalPosesTheEdgeSaysWhatToGive) {
  StoreRoom(calib::RecordedIn(calib::VirtualRoom(), 1, 43), false);
  StepAll();
  const Edge edge = OnlyEdge();
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  ASSERT_FALSE(edge.diagnoses.empty());
  EXPECT_EQ(edge.diagnoses[0].code, "no_nominal_pose");
  EXPECT_NE(edge.diagnoses[0].cure.find("T_ref_nominal"), std::string::npos);
}

TEST_F(LidarPipelineTest, ALostCloudCostsThePairUntilItIsSentAgain) {
  calib::LidarLidarProblem problem = calib::RecordedIn(calib::VirtualRoom(), 2, 47);
  const SessionId session = StoreRoom(problem, true);
  const std::string lost = Kitti(problem.captures[0].b_m);
  std::filesystem::remove(storage::BlobPath(store_->BlobFolder(), Sha256Of(lost)));
  StepAll();
  EXPECT_EQ(OnlyEdge().diagnoses.at(0).code, "file_lost");
  EXPECT_EQ(OnlyEdge().method, "lidar_lidar");
  ASSERT_TRUE(storage::AppendBlob(store_->BlobFolder(), lost));
  ASSERT_TRUE(storage::AppendHeld(*store_, session, {2}, clock_.now));
  StepAll();
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), false).value();
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [](const Edge& e) { return e.state == EdgeState::kGood; }), 1);
}

}  // namespace
}  // namespace rigcal::pipeline

// A camera that takes part in many pairs of a session is estimated once.

#include "tests/unit/pipeline_fixture.h"

namespace rigcal::pipeline {
namespace {

class PipelineCamerasTest : public PipelineTest {
 protected:
  // A camera, two lidars and a tracker: five pairs, three of them of the camera. Nothing of it can be read but the
  // poses.
  SessionId StoreRig() {
    Manifest manifest;
    manifest.header.robot = RobotId("r");
    manifest.header.reference = SensorId("camera");
    manifest.header.captured_at = clock_.now;
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = 0.025;
    board.plate_m = Eigen::Vector2d(0.4, 0.3);
    manifest.header.targets = {board};
    const std::pair<const char*, SensorKind> sensors[] = {{"camera", SensorKind::kCamera},
                                                          {"front", SensorKind::kLidar},
                                                          {"rear", SensorKind::kLidar},
                                                          {"body", SensorKind::kTracker}};
    for (const auto& [name, kind] : sensors) {
      Sensor sensor;
      sensor.id = SensorId(name);
      sensor.kind = kind;
      manifest.header.sensors.push_back(sensor);
    }
    AddFile("body/poses.csv", "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n01,1,0,0,0,0,0,0,1\n", manifest);
    for (const char* file :
         {"camera/01.png", "camera/02.png", "front/01.ply", "front/02.ply", "rear/01.ply", "rear/02.ply"})
      AddFile(file, std::string("nothing that can be read: ") + file, manifest);
    return Close(manifest);
  }

  void AddFile(const std::string& path, const std::string& bytes, Manifest& manifest) {
    const std::filesystem::path file(path);
    Payload payload;
    payload.path = path;
    payload.sensor = SensorId(file.parent_path().string());
    payload.capture = CaptureId(file.stem().string());
    payload.digest = *storage::AppendBlob(store_->BlobFolder(), bytes);
    payload.size_bytes = static_cast<std::int64_t>(bytes.size());
    manifest.payloads.push_back(payload);
  }
};

// Also where pictures have no board: they are part of the problem, whichever pair it comes from.
TEST_F(PipelineCamerasTest, IsEstimatedOnceForAllPairsOfASession) {
  int solved = 0;
  std::vector<std::size_t> views;
  calib::CameraMemory cameras([&](const calib::CameraProblem& problem) {
    ++solved;
    views.push_back(problem.views.size());
    return calib::EstimateCamera(problem);
  });
  const SessionId session = StoreRig();
  for (bool worked = true; worked;) {
    const auto result = Step({*store_, clock_, live_, claims_, announcer_, cameras});
    ASSERT_TRUE(result) << Sentence(result.error());
    worked = result->worked;
  }
  const auto edges = storage::LoadEdges(*store_, session);
  ASSERT_TRUE(edges);
  int of_camera = 0;
  for (const Edge& edge : *edges)
    if (edge.frame_a == SensorId("camera")) {
      ++of_camera;
      ASSERT_FALSE(edge.diagnoses.empty());
      EXPECT_EQ(edge.diagnoses[0].code, "too_few_captures") << edge.method << ": " << edge.diagnoses[0].what;
    }
  EXPECT_EQ(of_camera, 3);
  EXPECT_EQ(solved, 1);
  EXPECT_EQ(views, std::vector<std::size_t>{2});
}

}  // namespace
}  // namespace rigcal::pipeline

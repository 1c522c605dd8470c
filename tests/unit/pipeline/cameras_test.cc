// A camera that takes part in many pairs of a session is estimated once.
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

class PipelineCamerasTest : public PipelineTest {
 protected:
  // A camera and two more sensors. Of all the files only poses can be read.
  SessionId StoreRig(const std::string& robot, SensorKind first, SensorKind second) {
    Manifest manifest;
    manifest.header.robot = RobotId(robot);
    manifest.header.reference = SensorId("camera");
    manifest.header.captured_at = clock_.now;
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = 0.025;
    board.plate_m = Eigen::Vector2d(0.4, 0.3);
    manifest.header.targets = {board};
    AddSensor("camera", SensorKind::kCamera, manifest);
    AddSensor("first", first, manifest);
    AddSensor("second", second, manifest);
    return Close(manifest);
  }

  void AddSensor(const std::string& name, SensorKind kind, Manifest& manifest) {
    Sensor sensor;
    sensor.id = SensorId(name);
    sensor.kind = kind;
    manifest.header.sensors.push_back(sensor);
    const std::string robot = manifest.header.robot.str();
    if (kind == SensorKind::kTracker)
      return AddFile(name + "/poses.csv", "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n01,1,0,0,0,0,0,0,1\n", manifest);
    for (const std::string capture : {"01", "02"})
      AddFile(name + "/" + capture + (kind == SensorKind::kCamera ? ".png" : ".ply"), robot + name + capture, manifest);
  }

  void StepAllWith(calib::CameraMemory& cameras) {
    for (bool worked = true; worked;) {
      const auto result = Step({*store_, clock_, live_, claims_, announcer_, cameras});
      ASSERT_TRUE(result) << Sentence(result.error());
      worked = result->worked;
    }
  }
};

// Also where pictures have no board: they are part of the problem, whichever pair it comes from.
TEST_F(PipelineCamerasTest, IsEstimatedOnceForAllPairsOfASession) {
  const SensorKind lidar = SensorKind::kLidar, tracker = SensorKind::kTracker;
  for (const auto& [first, second] :
       {std::pair(lidar, lidar), std::pair(tracker, tracker), std::pair(lidar, tracker)}) {
    const std::string robot = NameOf(first) + "-" + NameOf(second);
    std::vector<std::size_t> views;  // of each problem that was solved
    calib::CameraMemory cameras([&](const calib::CameraProblem& problem) {
      views.push_back(problem.views.size());
      return calib::EstimateCamera(problem);
    });
    const SessionId session = StoreRig(robot, first, second);
    StepAllWith(cameras);
    const auto edges = storage::LoadEdges(*store_, session);
    ASSERT_TRUE(edges);
    int of_camera = 0;
    for (const Edge& edge : *edges) {
      if (edge.frame_a != SensorId("camera")) continue;
      ++of_camera;
      ASSERT_FALSE(edge.diagnoses.empty());
      EXPECT_EQ(edge.diagnoses[0].code, "too_few_captures") << edge.method << ": " << edge.diagnoses[0].what;
    }
    EXPECT_EQ(of_camera, 2) << robot;
    EXPECT_EQ(views, std::vector<std::size_t>{2}) << robot;
  }
}

}  // namespace
}  // namespace rigcal::pipeline

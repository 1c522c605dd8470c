// Coloured clouds through Step(): from a pushed session to the files of a published revision.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "server/pipeline/reports/cloud_choice.h"
#include "server/pipeline/reports/publish.h"
#include "storage/revisions/revisions.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWidth = 160, kHeight = 120;

// A picture that is `left` to the left of the middle and `right` beside it, as BGR.
std::string PngOf(const cv::Scalar& left, const cv::Scalar& right) {
  cv::Mat picture(kHeight, kWidth, CV_8UC3, right);
  picture.colRange(0, kWidth / 2).setTo(left);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

// A wall at z = 4 before the camera, which looks along z of the lidar too, and one behind it.
std::string WallPly() {
  std::string points;
  int count = 0;
  for (int y = -20; y <= 20; ++y)
    for (int x = -20; x <= 20; ++x)
      for (const int z : {4, -4}) {
        points += std::to_string(0.1 * x) + " " + std::to_string(0.1 * y) + " " + std::to_string(z) + "\n";
        ++count;
      }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + points;
}

class PipelineCloudsTest : public PipelineTest {
 protected:
  // Two cameras and a lidar; cameras see different boards, so that they give no pair.
  SessionId StoreRig(const std::map<std::string, std::string>& files, const std::vector<SensorId>& remounted = {},
                     const std::vector<SensorPair>& skip_pairs = {}) {
    Manifest manifest;
    manifest.header.remounted = remounted;
    manifest.header.skip_pairs = skip_pairs;
    manifest.header.robot = RobotId("r");
    manifest.header.reference = SensorId("lidar");
    manifest.header.captured_at = clock_.now;
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = 0.025;
    board.plate_m = Eigen::Vector2d(0.4, 0.3);
    manifest.header.targets = {board};
    for (const char* name : {"near", "far", "lidar"}) {
      Sensor sensor;
      sensor.id = SensorId(name);
      if (sensor.id.str() == "lidar") sensor.kind = SensorKind::kLidar;
      if (sensor.kind == SensorKind::kCamera)
        sensor.intrinsics = {100, 100, 79.5, 59.5, {0, 0, 0, 0, 0}, CameraModel::kPinholeRadtan};
      manifest.header.sensors.push_back(sensor);
    }
    for (const auto& [path, bytes] : files) AddFile(path, bytes, manifest);
    return Close(manifest);
  }

  // Poses as another tool would push them: both cameras at the lidar.
  void StorePoses() {
    std::vector<Edge> edges = {GivenEdge("r", "lidar", "near", 0), GivenEdge("r", "lidar", "far", 0.01)};
    AssignPushedIds(edges);
    StoreEdges(edges);
  }

  std::filesystem::path Newest() {
    int newest = 0;
    for (const auto& entry : std::filesystem::directory_iterator(store_->ReportFolder() / "r"))
      newest = std::max(newest, std::atoi(entry.path().filename().c_str()));
    return store_->ReportFolder() / "r" / std::to_string(newest);
  }
  static std::string Text(const std::filesystem::path& path) {
    std::stringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
  }
  static std::map<std::string, std::string> AllFiles(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) files[std::filesystem::relative(entry.path(), folder)] = Text(entry.path());
    return files;
  }
};

const cv::Scalar kRed(30, 30, 220), kBlue(220, 40, 40);

TEST_F(PipelineCloudsTest, APublishedRevisionHoldsTheColouredCloud) {
  StorePoses();
  // Capture 02 has the pictures of both cameras: it is chosen.
  StoreRig({{"near/01.png", PngOf(kBlue, kBlue)},
            {"lidar/01.ply", WallPly()},
            {"near/02.png", PngOf(kRed, kBlue)},
            {"far/02.png", PngOf(kRed, kBlue)},
            {"lidar/02.ply", WallPly()}});
  StepAll();
  const std::filesystem::path folder = Newest();
  for (const char* file : {"cloud/lidar/front.png", "cloud/lidar/top.png", "cloud/lidar/oblique.png",
                           "cloud/lidar/cloud.ply", "cloud/lidar/points.bin", "overlay/near.jpg",
                           "overlay/near_picture.jpg", "overlay/far.jpg", "overlay/far_picture.jpg"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  const std::string page = Text(folder / "index.html");
  EXPECT_THAT(page, HasSubstr("capture 02"));
  EXPECT_THAT(page, HasSubstr("3362 points"));
  EXPECT_THAT(page, HasSubstr("cloud/lidar/front.png"));
  EXPECT_THAT(page, HasSubstr("overlay/far.jpg"));

  const std::string points = Text(folder / "cloud/lidar/points.bin");
  ASSERT_EQ(points.size(), 28 + 12 * 3362u);
  int red = 0, blue = 0, green = 0;
  for (std::size_t at = 28; at < points.size(); at += 12) {
    const auto byte = [&](std::size_t i) { return static_cast<int>(static_cast<std::uint8_t>(points[at + i])); };
    const int x = static_cast<std::int16_t>(byte(0) | byte(1) << 8);
    red += byte(6) > 200 && x < 0 ? 1 : 0, blue += byte(8) > 200 && x > 0 ? 1 : 0, green += byte(9) == 255 ? 1 : 0;
  }
  EXPECT_GT(red, 700);  // of 41 x 41 before the camera, without the column in the middle and its neighbours
  EXPECT_GT(blue, 700);
  EXPECT_EQ(green, 1681);  // all that lie behind
}

// A picture from where the camera was before does not fit where it is now.
TEST_F(PipelineCloudsTest, NoColourComesFromACameraThatWasRemountedSince) {
  StorePoses();
  StoreRig({{"near/01.png", PngOf(kRed, kBlue)}, {"far/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", WallPly()}});
  clock_.now.ns += 1'000'000'000;
  StoreRig({{"near/01.png", PngOf(kBlue, kBlue)}}, {SensorId("near")});
  StepAll();
  EXPECT_TRUE(std::filesystem::exists(Newest() / "overlay/far.jpg"));
  EXPECT_FALSE(std::filesystem::exists(Newest() / "overlay/near.jpg"));
}

TEST_F(PipelineCloudsTest, NoColourComesFromACameraThatIsNotPairedWithTheLidar) {
  StorePoses();
  StoreRig({{"near/01.png", PngOf(kRed, kBlue)}, {"far/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", WallPly()}}, {},
           {{SensorId("near"), SensorId("lidar")}});
  StepAll();
  EXPECT_TRUE(std::filesystem::exists(Newest() / "overlay/far.jpg"));
  EXPECT_FALSE(std::filesystem::exists(Newest() / "overlay/near.jpg"));
}

TEST_F(PipelineCloudsTest, WhereTheLidarIsPairedWithNoneAllCamerasColour) {
  StorePoses();
  StoreRig({{"near/01.png", PngOf(kRed, kBlue)}, {"far/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", WallPly()}}, {},
           {{SensorId("near"), SensorId("lidar")}, {SensorId("lidar"), SensorId("far")}});
  StepAll();
  for (const char* file : {"overlay/far.jpg", "overlay/near.jpg"})
    EXPECT_TRUE(std::filesystem::exists(Newest() / file)) << file;
}

TEST_F(PipelineCloudsTest, PublishingAgainGivesTheSameBytes) {
  StorePoses();
  StoreRig({{"near/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", WallPly()}});
  StepAll();
  const std::filesystem::path folder = Newest();
  const auto first = AllFiles(folder);
  ASSERT_TRUE(first.contains("cloud/lidar/cloud.ply"));
  const int number = std::atoi(folder.filename().c_str());
  ASSERT_TRUE(Publish(*store_, {RobotId("r"), number}, clock_));
  EXPECT_TRUE(first == AllFiles(folder));
}

TEST_F(PipelineCloudsTest, WhatCannotBeReadIsASentenceNotAFailure) {
  StorePoses();
  StoreRig({{"near/01.png", "no picture"}, {"far/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", WallPly()}});
  StepAll();
  const std::filesystem::path folder = Newest();
  EXPECT_TRUE(std::filesystem::exists(folder / "overlay/far.jpg"));
  EXPECT_FALSE(std::filesystem::exists(folder / "overlay/near.jpg"));
  EXPECT_THAT(Text(folder / "index.html"), HasSubstr("near/01.png is not shown"));
  EXPECT_THAT(Text(folder / "index.html"), HasSubstr("seen by 1 camera"));
}

TEST_F(PipelineCloudsTest, ACloudThatCannotBeReadIsASentenceToo) {
  StorePoses();
  StoreRig({{"far/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", "no cloud"}});
  StepAll();
  EXPECT_THAT(Text(Newest() / "index.html"), HasSubstr("lidar/01.ply is not shown"));
  EXPECT_FALSE(std::filesystem::exists(Newest() / "cloud"));
}

TEST_F(PipelineCloudsTest, WithoutPosesOrAPictureOfTheSameMomentThereIsNoCloud) {
  StoreRig({{"near/01.png", PngOf(kRed, kBlue)}, {"lidar/01.ply", WallPly()}});
  StepAll();
  EXPECT_THAT(Text(Newest() / "index.html"), Not(HasSubstr("Coloured clouds")));
  StorePoses();
  clock_.now.ns += 1'000'000'000;
  StepAll();
  EXPECT_THAT(Text(Newest() / "index.html"), HasSubstr("Coloured clouds"));
}

TEST_F(PipelineCloudsTest, PicturesOfOtherMomentsDoNotColour) {
  StorePoses();
  StoreRig({{"near/01.png", PngOf(kRed, kBlue)}, {"far/02.png", PngOf(kRed, kBlue)}, {"lidar/03.ply", WallPly()}});
  StepAll();
  EXPECT_THAT(Text(Newest() / "index.html"), Not(HasSubstr("Coloured clouds")));
}

TEST(EstimatedIntrinsics, AreReadOfEitherKindOfEdge) {
  Edge edge;
  edge.frame_a = SensorId("l"), edge.frame_b = SensorId("r");
  edge.figures = {{"fx_b_px", 500},    {"fy_b_px", 501},    {"cx_b_px", 320},
                  {"cy_b_px", 240},    {"k1_b_ratio", 0.1}, {"k2_b_ratio", 0.2},
                  {"p1_b_ratio", 0.3}, {"p2_b_ratio", 0.4}, {"k3_b_ratio", 0.5}};
  const auto right = EstimatedIntrinsics(edge, SensorId("r"), CameraModel::kPinholeRadtan);
  ASSERT_TRUE(right);
  EXPECT_EQ(right->fy_px, 501);
  EXPECT_EQ(right->distortion, (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_FALSE(EstimatedIntrinsics(edge, SensorId("l"), CameraModel::kPinholeRadtan));
  EXPECT_FALSE(EstimatedIntrinsics(edge, SensorId("x"), CameraModel::kPinholeRadtan));
  EXPECT_FALSE(EstimatedIntrinsics(edge, SensorId("r"), CameraModel::kPinholeRational));  // k4 is missing
  edge.figures = {{"fx_px", 400},    {"fy_px", 401},    {"cx_px", 320},    {"cy_px", 240},
                  {"k1_ratio", 0.1}, {"k2_ratio", 0.2}, {"k3_ratio", 0.3}, {"k4_ratio", 0.4}};
  const auto fisheye = EstimatedIntrinsics(edge, SensorId("r"), CameraModel::kFisheyeKb4);
  ASSERT_TRUE(fisheye);
  EXPECT_EQ(fisheye->fx_px, 400);
  EXPECT_EQ(fisheye->distortion.size(), 4u);
  edge.figures = {{"fx_px", 240}, {"fy_px", 241},     {"cx_px", 320},
                  {"cy_px", 240}, {"xi_ratio", -0.2}, {"alpha_ratio", 0.6}};
  const auto sphere = EstimatedIntrinsics(edge, SensorId("r"), CameraModel::kDoubleSphere);
  ASSERT_TRUE(sphere);
  EXPECT_EQ(sphere->distortion, (std::vector<double>{-0.2, 0.6}));
  EXPECT_FALSE(EstimatedIntrinsics(edge, SensorId("r"), CameraModel::kEucm));  // beta is missing
}

}  // namespace
}  // namespace rigcal::pipeline

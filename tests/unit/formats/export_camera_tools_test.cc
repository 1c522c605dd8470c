// What leaves for OpenCV, Kalibr, KITTI, COLMAP and Basalt: read by OpenCV, yaml-cpp and nlohmann-json, and a point of
// the lidar followed into a picture by each format's own formula.
#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <sstream>

#include "tests/unit/formats/export_sample.h"

namespace rigcal::exports {
namespace {

using nlohmann::json;
using sample::Rig;
using sample::TextOf;
using sample::Truth;
using testing::HasSubstr;

constexpr double kRounding = 1e-12;

Eigen::Vector3d LeftOfRight(const Eigen::Vector3d& p_right) { return Truth().at("right") * p_right; }

TEST(ExportOpenCv, FileStorageReadsMatricesThatProjectAsTheCalibrationDoes) {
  const cv::FileStorage file(TextOf(WriteOpenCv),
                             cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
  ASSERT_TRUE(file.isOpened());
  EXPECT_EQ(file["root"].string(), "left");
  ASSERT_EQ(file["sensors"].size(), 5U);
  for (const cv::FileNode& sensor : file["sensors"]) {
    const auto& truth = Truth().at(sensor["frame"].string());
    const cv::Mat T = sensor["T_root_sensor"].mat();
    ASSERT_EQ(T.size(), cv::Size(4, 4));
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        EXPECT_NEAR(T.at<double>(row, column), truth.R(row, column), kRounding);
      EXPECT_NEAR(T.at<double>(row, 3), truth.t[row], kRounding);
    }
  }
  const cv::FileNode left = file["sensors"][0], right = file["sensors"][1];
  EXPECT_EQ(static_cast<int>(left["image_width"]), 640);
  EXPECT_EQ(right["model"].string(), "fisheye_kb4");
  std::vector<cv::Point2d> uv;
  cv::projectPoints(std::vector<cv::Point3d>{{0.5, -0.25, 2.0}}, cv::Vec3d(), cv::Vec3d(), left["camera_matrix"].mat(),
                    left["distortion_coefficients"].mat(), uv);
  const double x = 0.25, y = -0.125, r2 = x * x + y * y, k = 1 - 0.25 * r2 + 0.0625 * r2 * r2;
  EXPECT_NEAR(uv[0].x, 320.125 + 500.5 * (x * k + 2 * 0.001 * x * y - 0.002 * (r2 + 2 * x * x)), 1e-9);
  EXPECT_NEAR(uv[0].y, 239.75 + 510.25 * (y * k + 0.001 * (r2 + 2 * y * y) - 2 * 0.002 * x * y), 1e-9);
}

TEST(ExportKalibr, TheChainMapsPointsOfTheCameraBefore) {
  const YAML::Node chain = YAML::Load(TextOf(WriteKalibr));
  ASSERT_EQ(chain.size(), 2U);
  EXPECT_FALSE(chain["cam0"]["T_cn_cnm1"]);
  EXPECT_EQ(chain["cam0"]["distortion_model"].as<std::string>(), "radtan");
  EXPECT_EQ(chain["cam0"]["distortion_coeffs"].as<std::vector<double>>(),
            (std::vector<double>{-0.25, 0.0625, 0.001, -0.002}));
  EXPECT_EQ(chain["cam1"]["distortion_model"].as<std::string>(), "equidistant");
  EXPECT_EQ(chain["cam1"]["intrinsics"].as<std::vector<double>>(),
            (std::vector<double>{500.5, 510.25, 320.125, 239.75}));
  const auto T = chain["cam1"]["T_cn_cnm1"].as<std::vector<std::vector<double>>>();
  const Eigen::Vector3d p_right(0.3, -0.2, 4.0), p_left = LeftOfRight(p_right);
  for (std::size_t row = 0; row < 3; ++row) {
    const double mapped = T[row][0] * p_left.x() + T[row][1] * p_left.y() + T[row][2] * p_left.z() + T[row][3];
    EXPECT_NEAR(mapped, p_right[static_cast<Eigen::Index>(row)], kRounding);
  }
  EXPECT_EQ(T[3], (std::vector<double>{0, 0, 0, 1}));
}

// Kalibr's radtan has no k3: without it the picture's corners would be wrong.
TEST(ExportKalibr, ALensThatItCannotHoldIsLeftOutAndSaid) {
  Calibration rig = Rig();
  rig.sensors[0].camera->intrinsics.distortion[4] = 0.01;
  const auto written = WriteKalibr(rig);
  ASSERT_TRUE(written);
  EXPECT_THAT(written->left_out, testing::Contains(HasSubstr("left: Kalibr's radtan has k1 k2 p1 p2 only")));
  EXPECT_THAT(written->left_out, testing::Contains("lidar: a camera chain has cameras only"));
  const YAML::Node chain = YAML::Load(written->files[0].text);
  ASSERT_EQ(chain.size(), 1U);
  EXPECT_EQ(chain["cam0"]["rigcal_frame"].as<std::string>(), "right");
  rig.sensors.erase(rig.sensors.begin() + 1);
  EXPECT_EQ(WriteKalibr(rig).error().code, ErrorCode::kUnsupported);
}

// left is eucm, right double_sphere.
Calibration SphereRig() {
  Calibration rig = Rig();
  rig.sensors[0].camera = sample::Camera("left", CameraModel::kEucm, {0.625, 1.125});
  rig.sensors[1].camera = sample::Camera("right", CameraModel::kDoubleSphere, {-0.1875, 0.5625});
  return rig;
}

// Kalibr reads alpha beta fu fv pu pv of eucm, xi alpha fu fv pu pv of ds, and no distortion besides.
TEST(ExportKalibr, SphereModelsAreCamerasWithoutDistortion) {
  const YAML::Node chain = YAML::Load(TextOf(WriteKalibr, SphereRig()));
  ASSERT_EQ(chain.size(), 2U);
  EXPECT_EQ(chain["cam0"]["camera_model"].as<std::string>(), "eucm");
  EXPECT_EQ(chain["cam0"]["intrinsics"].as<std::vector<double>>(),
            (std::vector<double>{0.625, 1.125, 500.5, 510.25, 320.125, 239.75}));
  EXPECT_EQ(chain["cam1"]["camera_model"].as<std::string>(), "ds");
  EXPECT_EQ(chain["cam1"]["intrinsics"].as<std::vector<double>>(),
            (std::vector<double>{-0.1875, 0.5625, 500.5, 510.25, 320.125, 239.75}));
  for (const char* camera : {"cam0", "cam1"}) {
    EXPECT_EQ(chain[camera]["distortion_model"].as<std::string>(), "none");
    EXPECT_EQ(chain[camera]["distortion_coeffs"].size(), 0U);
  }
}

TEST(ExportBasalt, SphereModelsHaveTheirNumbersByName) {
  const json intrinsics = json::parse(TextOf(WriteBasalt, SphereRig()))["value0"]["intrinsics"];
  EXPECT_EQ(
      intrinsics[0].dump(),
      R"({"camera_type":"eucm","intrinsics":{"alpha":0.625,"beta":1.125,"cx":320.125,"cy":239.75,"fx":500.5,"fy":510.25}})");
  EXPECT_EQ(
      intrinsics[1].dump(),
      R"({"camera_type":"ds","intrinsics":{"alpha":0.5625,"cx":320.125,"cy":239.75,"fx":500.5,"fy":510.25,"xi":-0.1875}})");
}

TEST(ExportOpenCv, OfASphereModelThePoseAlone) {
  const auto written = WriteOpenCv(SphereRig());
  ASSERT_TRUE(written);
  EXPECT_THAT(written->left_out, testing::Contains("intrinsics of left: eucm is a lens that OpenCV does not have"));
  const cv::FileStorage file(written->files[0].text,
                             cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
  EXPECT_EQ(file["sensors"][1]["T_root_sensor"].mat().at<double>(0, 3), 0.25);
  EXPECT_TRUE(file["sensors"][1]["distortion_coefficients"].empty());
  EXPECT_TRUE(file["sensors"][1]["camera_matrix"].empty());
}

TEST(ExportFormats, WhatHasNoSphereModelsLeavesThemOutAndSaysSo) {
  for (const Writer writer : {WriteColmap, WriteCameraInfo, WriteKitti}) {
    Calibration rig = SphereRig();
    rig.sensors[0] = Rig().sensors[0];
    const auto some = writer(rig);
    ASSERT_TRUE(some);
    EXPECT_THAT(some->left_out, testing::Contains(testing::StartsWith("right: "))) << some->files[0].text;
    EXPECT_THAT(some->files[0].text, HasSubstr("double_sphere")) << "said in the file, too";
    EXPECT_FALSE(writer(SphereRig()));
  }
  EXPECT_EQ(WriteCameraInfo(SphereRig()).error().what, "right: double_sphere is a lens that camera_info does not have");
  EXPECT_THAT(WriteColmap(SphereRig()).error().cure, HasSubstr("kalibr, basalt or json"));
}

std::map<std::string, std::vector<double>> KittiFields(const std::string& text) {
  std::map<std::string, std::vector<double>> fields;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    EXPECT_NE(colon, std::string::npos) << "readers split every line at a colon: " << line;
    std::istringstream numbers(line.substr(colon + 1));
    for (double value = 0; numbers >> value;) fields[line.substr(0, colon)].push_back(value);
  }
  return fields;
}

TEST(ExportKitti, ALidarPointIsProjectedByTheFilesOwnMatrices) {
  Calibration rig = Rig();
  rig.sensors[1].camera->intrinsics = rig.sensors[0].camera->intrinsics;
  auto fields = KittiFields(TextOf(WriteKitti, rig));
  const Eigen::Vector3d p_right(0.3, -0.2, 4.0), p_left = LeftOfRight(p_right),
                                                 p_lidar = Truth().at("lidar").Back(p_left);
  ASSERT_EQ(fields["Tr"].size(), 12U);
  ASSERT_EQ(fields["P1"].size(), 12U);
  const auto map = [](const std::vector<double>& m, const Eigen::Vector3d& p) {
    return Eigen::Vector3d(m[0] * p.x() + m[1] * p.y() + m[2] * p.z() + m[3],
                           m[4] * p.x() + m[5] * p.y() + m[6] * p.z() + m[7],
                           m[8] * p.x() + m[9] * p.y() + m[10] * p.z() + m[11]);
  };
  const Eigen::Vector3d p_cam0 = map(fields["Tr"], p_lidar), uvw = map(fields["P1"], p_cam0);
  EXPECT_LT((p_cam0 - p_left).norm(), kRounding);
  EXPECT_NEAR(uvw.x() / uvw.z(), 320.125 + 500.5 * 0.3 / 4.0, 1e-9);
  EXPECT_NEAR(uvw.y() / uvw.z(), 239.75 - 510.25 * 0.2 / 4.0, 1e-9);
  EXPECT_EQ(fields["S_01"], (std::vector<double>{640, 480}));
  EXPECT_EQ(fields["D_00"].size(), 5U);
}

TEST(ExportKitti, AFisheyeIsLeftOut) {
  const auto written = WriteKitti(Rig());
  ASSERT_TRUE(written);
  EXPECT_THAT(written->left_out, testing::Contains(HasSubstr("right: KITTI's files hold k1 k2 p1 p2 k3 only")));
  EXPECT_THAT(written->left_out, testing::Contains("mast: KITTI's files hold cameras and lidars"));
}

TEST(ExportColmap, CountsPixelsFromTheCornerAndMapsRigPointsIntoTheCamera) {
  const auto written = WriteColmap(Rig());
  ASSERT_TRUE(written);
  ASSERT_EQ(written->files.size(), 2U);
  std::istringstream lines(written->files[0].text);
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);)
    if (line.front() != '#') rows.push_back(line);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0], "1 FULL_OPENCV 640 480 500.5 510.25 320.625 240.25 -0.25 0.0625 0.001 -0.002 0.0 0.0 0.0 0.0");
  EXPECT_EQ(rows[1], "2 OPENCV_FISHEYE 640 480 500.5 510.25 320.625 240.25 0.03 -0.004 5.0e-04 1.0e-05");
  const json cameras = json::parse(written->files[1].text)[0]["cameras"];
  EXPECT_TRUE(cameras[0]["ref_sensor"].get<bool>());
  EXPECT_EQ(cameras[1]["image_prefix"].get<std::string>(), "right/");
  const auto q = cameras[1]["cam_from_rig_rotation"].get<std::vector<double>>();  // w x y z
  const auto t = cameras[1]["cam_from_rig_translation"].get<std::vector<double>>();
  const Eigen::Vector3d v(q[1], q[2], q[3]), p_right(0.3, -0.2, 4.0), p = LeftOfRight(p_right);
  const Eigen::Vector3d mapped =
      p + 2 * q[0] * v.cross(p) + 2 * v.cross(v.cross(p)) + Eigen::Vector3d(t[0], t[1], t[2]);
  EXPECT_LT((mapped - p_right).norm(), kRounding);
}

// As Basalt's reader asks for it: the first member of the file, then members by their names.
TEST(ExportBasalt, HasTheMembersThatBasaltReads) {
  const std::string text = TextOf(WriteBasalt);
  EXPECT_EQ(text.rfind("{\"value0\":", 0), 0U) << "Basalt takes the first member of the file";
  const json calibration = json::parse(text)["value0"];
  const json right = calibration["T_imu_cam"][1];
  const auto number = [&](const char* key) { return right[key].get<double>(); };
  const Eigen::Vector3d v(number("qx"), number("qy"), number("qz")), p(1, 2, 3),
      t(number("px"), number("py"), number("pz"));
  const Eigen::Vector3d mapped = p + 2 * number("qw") * v.cross(p) + 2 * v.cross(v.cross(p)) + t;
  EXPECT_LT((mapped - LeftOfRight(p)).norm(), kRounding);
  EXPECT_EQ(calibration["intrinsics"][0]["camera_type"].get<std::string>(), "pinhole-radtan8");
  EXPECT_EQ(calibration["intrinsics"][0]["intrinsics"]["p2"].get<double>(), -0.002);
  EXPECT_EQ(calibration["intrinsics"][1]["camera_type"].get<std::string>(), "kb4");
  EXPECT_EQ(calibration["intrinsics"][1]["intrinsics"]["k3"].get<double>(), 0.0005);
  EXPECT_EQ(calibration["resolution"][1].dump(), "[640,480]");
}

TEST(ExportJsonAndCsv, HaveEveryNumberAtItsPlace) {
  const json document = json::parse(TextOf(WriteCalibrationJson));
  EXPECT_EQ(document["root"].get<std::string>(), "left");
  EXPECT_EQ(document["left_out"][0].get<std::string>(), "tail: the height was not measured");
  EXPECT_EQ(document["sensors"][2]["T_root_sensor"]["q_xyzw"].dump(), "[0.0,0.0,1.0,0.0]");
  EXPECT_NEAR(document["sensors"][2]["sigma_rad"][2].get<double>(), 0.002 * std::sqrt(6.0), kRounding);
  EXPECT_EQ(document["sensors"][1]["camera"]["intrinsics"]["model"].get<std::string>(), "fisheye_kb4");
  const std::string csv = TextOf(WriteCalibrationCsv);
  EXPECT_THAT(csv, HasSubstr("\nlidar,lidar,-1.5,0.75,0.125,0.0,0.0,1.0,0.0,0.002,"));
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.front() == '#' || std::count(line.begin(), line.end(), ',') == 22) << line;
}

TEST(ExportFormats, TheSuffixOrTheNameTellsWhich) {
  EXPECT_EQ((*FormatOfFile("a/robot.urdf"))->name, "urdf");
  EXPECT_EQ((*FormatOfFile("robot.tf.yaml"))->name, "tf2");
  EXPECT_EQ((*FormatOfFile("robot.launch.xml"))->name, "tf2_launch");
  EXPECT_THAT(FormatOfFile("robot.yaml").error().what, HasSubstr("names no format"));
  EXPECT_THAT(FormatCalled("urfd").error().cure, HasSubstr("urdf, tf2, tf2_launch, kalibr"));
  for (const Format& format : Formats()) {
    ASSERT_TRUE(format.write(Rig())) << format.name;
    EXPECT_EQ(TextOf(format.write), TextOf(format.write)) << format.name;
  }
}

}  // namespace
}  // namespace rigcal::exports

#include "server/formats/edges/camera_fit.h"

#include <gtest/gtest.h>

namespace rigcal::formats {
namespace {

CameraFit Sample() {
  CameraFit fit;
  fit.camera = SensorId("front");
  fit.width_px = 640, fit.height_px = 480;
  fit.source = IntrinsicsSource::kEstimated;
  fit.intrinsics = {600.5, 601.25, 320.0, 240.0, {-0.1, 0.02, 0.0, 0.001, 0.0}, CameraModel::kPinholeRadtan};
  fit.sigma = {0.5, 0.5, 0.25, 0.25, 0.001, 0.002, 0.0001, 0.0001, 0.003};
  fit.sigma_by_jackknife = true;
  fit.covariance = Eigen::VectorXd::LinSpaced(9, 0.25, 2.25).asDiagonal();
  fit.covariance(7, 2) = fit.covariance(2, 7) = -0.125;
  fit.implied_motion = Eigen::MatrixXd::Zero(6, 9);
  fit.implied_motion(3, 1) = 0.5, fit.implied_motion(5, 8) = -0.0625;
  ViewFit view;
  view.capture = CaptureId("003");
  view.uv_px = {{10.12, 20.34}, {30.5, 40.25}};
  view.residual_px = {{0.125, -0.25}, {-0.001, 0.5}};
  view.distance_m = 1.25;
  view.tilt_rad = {0.25, -0.125};
  fit.views = {view, {CaptureId("004"), {{1.0, 2.0}}, {}, 0.0, {0.0, 0.0}}};
  return fit;
}

std::string Replaced(std::string text, const std::string& old, const std::string& by) {
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return at == std::string::npos ? text : text.replace(at, old.size(), by);
}

TEST(CameraFitDocument, ComesBackAsItWas) {
  const std::string text = WriteCameraFit(Sample());
  const auto fit = ReadCameraFit(text);
  ASSERT_TRUE(fit) << Sentence(fit.error());
  EXPECT_EQ(WriteCameraFit(*fit), text);
  EXPECT_EQ(fit->camera, SensorId("front"));
  EXPECT_EQ(fit->views[0].residual_px[1], Eigen::Vector2d(-0.001, 0.5));
  EXPECT_EQ(fit->views[0].uv_px[0], Eigen::Vector2d(10.12, 20.34));
  EXPECT_EQ(fit->views[0].tilt_rad, Eigen::Vector2d(0.25, -0.125));
  EXPECT_TRUE(fit->views[1].residual_px.empty());
  EXPECT_EQ(fit->sigma, Sample().sigma);
  EXPECT_EQ(fit->covariance, Sample().covariance);
  EXPECT_EQ(fit->implied_motion, Sample().implied_motion);
}

TEST(CameraFitDocument, HoldsSphereModels) {
  CameraFit sample = Sample();
  sample.intrinsics.model = CameraModel::kEucm, sample.intrinsics.distortion = {0.61, 1.07};
  sample.sigma.resize(6);
  sample.covariance = Eigen::VectorXd::LinSpaced(6, 0.25, 1.5).asDiagonal();
  sample.implied_motion = Eigen::MatrixXd::Constant(6, 6, 0.125);
  const std::string text = WriteCameraFit(sample);
  const auto fit = ReadCameraFit(text);
  ASSERT_TRUE(fit) << Sentence(fit.error());
  EXPECT_EQ(fit->intrinsics, sample.intrinsics);
  EXPECT_EQ(WriteCameraFit(*fit), text);
  EXPECT_FALSE(ReadCameraFit(Replaced(text, "[0.61,1.07]", "[0.61]")));
}

// As the documents that are stored.
TEST(CameraFitDocument, OfBeforeHasNoCovariance) {
  std::string text = WriteCameraFit(Sample());
  for (const std::string key : {"covariance", "implied_motion"}) {
    const auto from = text.find("\"" + key + "\":"), end = text.find("]],", from);
    ASSERT_NE(end, std::string::npos) << key;
    text.erase(from, end + 3 - from);
  }
  const auto fit = ReadCameraFit(text);
  ASSERT_TRUE(fit) << Sentence(fit.error());
  EXPECT_EQ(fit->covariance.size(), 0);
  EXPECT_EQ(fit->implied_motion.size(), 0);
  EXPECT_EQ(fit->sigma, Sample().sigma);
}

TEST(CameraFitDocument, WhatWasGivenHasNoCovariance) {
  CameraFit given = Sample();
  given.covariance = given.implied_motion = Eigen::MatrixXd();
  const auto fit = ReadCameraFit(WriteCameraFit(given));
  ASSERT_TRUE(fit) << Sentence(fit.error());
  EXPECT_EQ(fit->covariance.size(), 0);
}

TEST(CameraFitDocument, WithoutAnEstimateThereAreNoIntrinsics) {
  CameraFit seen = Sample();
  seen.source = IntrinsicsSource::kNone;
  const auto fit = ReadCameraFit(WriteCameraFit(seen));
  ASSERT_TRUE(fit) << Sentence(fit.error());
  EXPECT_EQ(fit->source, IntrinsicsSource::kNone);
}

TEST(CameraFitDocument, WhatIsWrongIsNamed) {
  const std::string text = WriteCameraFit(Sample());
  for (const auto& [old, by, named] :
       std::vector<std::array<std::string, 3>>{{"[0.125,-0.25,-0.001,0.5]", "[0.125,-0.25]", "residual"},
                                               {"[10.12,20.34,30.5,40.25]", "[10.12,20.34,30.5]", "uv_px"},
                                               {"\"pinhole_radtan\"", "\"eye\"", "model"},
                                               {"\"estimated\"", "\"guessed\"", "source"},
                                               {"\"format\":1", "\"format\":2", "format"},
                                               {"\"width_px\":640", "\"width_px\":-1", "width_px"},
                                               {"\"covariance\":[[0.25],", "\"covariance\":[", "covariance"},
                                               {"\"implied_motion\":[", "\"implied_motion\":[[0],", "implied_motion"},
                                               {"[0.25,-0.125]", "[0.25]", "tilt_rad"}}) {
    const auto fit = ReadCameraFit(Replaced(text, old, by));
    ASSERT_FALSE(fit) << by;
    EXPECT_NE(fit.error().what.find(named), std::string::npos) << fit.error().what;
  }
  EXPECT_FALSE(ReadCameraFit("{}"));
  EXPECT_FALSE(ReadCameraFit("not json"));
}

}  // namespace
}  // namespace rigcal::formats

// What is written comes back: PLY through the service's own reader, points.bin by its contract.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <span>

#include "server/cloud/point_files.h"
#include "server/formats/clouds/cloud.h"

namespace rigcal::cloud {
namespace {

ColouredCloud Sample(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> side(-20, 35);
  ColouredCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points_m.emplace_back(side(random), side(random), 0.1F * side(random));
    const auto value = static_cast<std::uint8_t>(i);
    cloud.rgb.push_back({value, static_cast<std::uint8_t>(255 - value), 7});
    cloud.camera_idx.push_back(i % 3 == 0 ? kNoCamera : static_cast<std::uint8_t>(i % 3));
    cloud.intensity.push_back(static_cast<std::uint8_t>(i / 2));
  }
  return cloud;
}

template <typename T>
T At(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST(PointFiles, PlyIsReadBack) {
  const ColouredCloud cloud = Sample(500);
  const std::string bytes = WritePly(cloud);
  const auto read = formats::ReadCloud(std::as_bytes(std::span(bytes)), "ply", "cloud.ply");
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->points_m.size(), 500u);
  ASSERT_EQ(read->fields.size(), 5u);
  const std::vector<std::string> names = {"red", "green", "blue", "camera", "intensity"};
  for (std::size_t f = 0; f < names.size(); ++f) EXPECT_EQ(read->fields[f].name, names[f]);
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_EQ(read->points_m[i], cloud.points_m[i]);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(read->fields[c].values[i], cloud.rgb[i][c]);
    EXPECT_EQ(read->fields[3].values[i], cloud.camera_idx[i]);
    EXPECT_EQ(read->fields[4].values[i], cloud.intensity[i]);
  }
}

TEST(PointFiles, ViewerPointsKeepTheContract) {
  const ColouredCloud cloud = Sample(500);
  const std::string bytes = WriteViewerPoints(cloud);
  ASSERT_EQ(bytes.size(), 28 + 12 * 500u);
  EXPECT_EQ(bytes.substr(0, 4), "RCLD");
  EXPECT_EQ(At<std::uint32_t>(bytes, 4), 1u);
  EXPECT_EQ(At<std::uint32_t>(bytes, 8), 500u);
  const Eigen::Vector3f origin(At<float>(bytes, 12), At<float>(bytes, 16), At<float>(bytes, 20));
  const float step = At<float>(bytes, 24);
  EXPECT_LT(step, 0.001F);  // 55 m over 65535 steps
  for (std::size_t i = 0; i < 500; ++i) {
    const std::size_t at = 28 + 12 * i;
    const Eigen::Vector3f value(At<std::int16_t>(bytes, at), At<std::int16_t>(bytes, at + 2),
                                At<std::int16_t>(bytes, at + 4));
    EXPECT_LE((origin + step * value - cloud.points_m[i]).cwiseAbs().maxCoeff(), 0.51F * step + 1e-5F);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(At<std::uint8_t>(bytes, at + 6 + c), cloud.rgb[i][c]);
    EXPECT_EQ(At<std::uint8_t>(bytes, at + 9), cloud.camera_idx[i]);
    EXPECT_EQ(At<std::uint8_t>(bytes, at + 10), cloud.intensity[i]);
    EXPECT_EQ(At<std::uint8_t>(bytes, at + 11), 0);
  }
}

TEST(PointFiles, FarPointsDoNotCoarsenTheViewersSteps) {
  ColouredCloud cloud = Sample(50);
  cloud.points_m[7] = {9e4F, 0, 0};
  const std::string bytes = WriteViewerPoints(cloud);
  EXPECT_EQ(At<std::uint32_t>(bytes, 8), 49u);
  EXPECT_EQ(bytes.size(), 28 + 12 * 49u);
  EXPECT_LT(At<float>(bytes, 24), 0.001F);
}

TEST(PointFiles, AnEmptyCloudIsAHeader) {
  const std::string points = WriteViewerPoints({}), ply = WritePly({});
  EXPECT_EQ(points.size(), 28u);
  EXPECT_GT(At<float>(points, 24), 0.0F);
  EXPECT_NE(ply.find("element vertex 0\n"), std::string::npos);
}

}  // namespace
}  // namespace rigcal::cloud

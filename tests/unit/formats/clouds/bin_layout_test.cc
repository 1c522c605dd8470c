// What a .bin holds: given, or certain from its numbers, or asked for. Clouds are of a rotating lidar in a room, and
// real ones packed anew.
#include "server/formats/clouds/bin_layout.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/unit/formats/clouds/cloud_samples.h"

namespace rigcal::formats {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr std::size_t kRings = 16;
struct Row {
  std::array<double, 8> values;  // x y z intensity ring time and two more
};

// Beams from within a box of 11 m, 7 m and 3 m.
std::vector<Row> RoomScan(std::size_t columns) {
  std::vector<Row> rows;
  std::mt19937 random(5);
  std::normal_distribution<double> noise_m(0.0, 0.02);
  for (std::size_t i = 0; i < columns * kRings; ++i) {
    const double azimuth = 2 * M_PI * static_cast<double>(i / kRings) / static_cast<double>(columns);
    const double elevation = (static_cast<double>(i % kRings) * 2 - 15) * M_PI / 180;
    const std::array<double, 3> d = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                     std::sin(elevation)};
    double range_m = 1e9;
    for (const auto& [axis, wall_m] : {std::pair(0, 7.0), {0, -4.0}, {1, 3.0}, {1, -4.0}, {2, 1.8}, {2, -1.2}})
      if (const double to_wall_m = wall_m / d[static_cast<std::size_t>(axis)]; to_wall_m > 0)
        range_m = std::min(range_m, to_wall_m);
    range_m += noise_m(random);
    const double intensity = std::abs(0.4 + 0.1 * std::sin(5 * azimuth) + noise_m(random));
    rows.push_back({{range_m * d[0], range_m * d[1], range_m * d[2], intensity, static_cast<double>(i % kRings),
                     static_cast<double>(i) * 1e-6, 1.0, 0.0}});
  }
  return rows;
}

template <typename T>
std::string Pack(const std::vector<Row>& rows, std::size_t numbers) {
  std::string bytes;
  for (const Row& row : rows)
    for (std::size_t k = 0; k < numbers; ++k) bytes += Little(static_cast<T>(row.values[k]));
  return bytes;
}

bool IsCertain(const std::string& bytes) { return CheckBinLayout(bytes, {}, "top/01.bin").has_value(); }

TEST(BinLayout, OnlyFourFloatsAreCertainToBeKittis) {
  const std::vector<Row> rows = RoomScan(600);  // 9,600 points: all sizes are multiples of 16
  for (std::size_t numbers = 3; numbers <= 8; ++numbers) {
    EXPECT_EQ(IsCertain(Pack<float>(rows, numbers)), numbers == 4) << numbers;
    EXPECT_FALSE(IsCertain(Pack<double>(rows, numbers))) << numbers;
  }
}

TEST(BinLayout, TheOrderOfPointsDoesNotMatter) {
  std::vector<Row> rows = RoomScan(600);
  std::shuffle(rows.begin(), rows.end(), std::mt19937(3));
  for (std::size_t numbers = 3; numbers <= 8; ++numbers)
    EXPECT_EQ(IsCertain(Pack<float>(rows, numbers)), numbers == 4) << numbers;
}

TEST(BinLayout, BeamsWithoutAReturnDoNotMatter) {
  std::vector<Row> rows = RoomScan(600);
  std::mt19937 random(9);
  std::vector<std::size_t> lost;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (random() % 3 == 0) lost.push_back(i);
  for (const std::size_t i : lost) rows[i].values = {0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_TRUE(IsCertain(Pack<float>(rows, 4)));
  EXPECT_FALSE(IsCertain(Pack<float>(rows, 5)));
  for (const std::size_t i : lost) rows[i].values = {NAN, NAN, NAN, 0, 0, 0, 0, 0};
  EXPECT_TRUE(IsCertain(Pack<float>(rows, 4)));
  EXPECT_FALSE(IsCertain(Pack<float>(rows, 5)));
}

TEST(BinLayout, TheErrorNamesFileSensorAndTheLineToWrite) {
  const auto refused = [](const std::string& bytes) { return CheckBinLayout(bytes, {}, "top/01.bin").error(); };
  const Error five = refused(Pack<float>(RoomScan(600), 5));
  EXPECT_THAT(five.what, HasSubstr("file \"top/01.bin\": it is not certain to hold KITTI's 4 floats a point"));
  EXPECT_THAT(five.what, HasSubstr("its numbers repeat every 5"));
  EXPECT_THAT(five.cure, HasSubstr("under sensor 'top'"));
  EXPECT_THAT(five.cure, HasSubstr("fields: [x, y, z, intensity, ring]"));
  EXPECT_THAT(refused(Pack<float>(RoomScan(600), 3)).cure, HasSubstr("fields: [x, y, z] "));
  EXPECT_THAT(refused(std::string(1001, 'a')).what, HasSubstr("has 1001 bytes, which is no multiple of 16"));
  EXPECT_THAT(refused(Pack<float>(RoomScan(10), 4)).what, HasSubstr("too few to tell"));
  EXPECT_THAT(refused(Pack<double>(RoomScan(600), 4)).cure, HasSubstr("point_type: float64"));
}

TEST(BinLayout, GivenFieldsAreRead) {
  const std::vector<Row> rows = RoomScan(20);
  const CloudLayout five{{"x", "y", "z", "intensity", "ring"}, PointType::kFloat32};
  const CloudLayout turned{{"intensity", "z", "y", "x"}, PointType::kFloat64};
  std::string mixed;
  for (const Row& row : rows)
    for (const std::size_t k : {3, 2, 1, 0}) mixed += Little(row.values[k]);
  const auto read = [](const std::string& bytes, const CloudLayout& layout) {
    return ReadCloud(std::as_bytes(std::span(bytes)), "bin", "top/01.bin", layout);
  };
  const auto a = read(Pack<float>(rows, 5), five), b = read(mixed, turned);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->points_m, b->points_m);
  ASSERT_EQ(a->points_m.size(), rows.size());
  EXPECT_EQ(a->fields.at(1).name, "ring");
  EXPECT_EQ(a->fields.at(1).values.at(17), 1.0);
  EXPECT_EQ(b->fields.at(0).values.at(17), rows[17].values[3]);
  const auto wrong = read(Pack<float>(rows, 5).substr(4), five);
  EXPECT_THAT(wrong.error().what,
              HasSubstr("no multiple of 20, a point of session.yaml's fields (x y z intensity ring, float32)"));
}

// The clouds of `../shared/data`, with what intensity they have.
TEST(BinLayout, RealCloudsPackedAnew) {
  const fs::path data = fs::path(RIGCAL_SOURCE_DIR) / "../shared/data";
  int clouds = 0;
  for (const char* folder : {"lidarlidar_opencalib", "lidarlidar_small_gicp", "lidarlidar_ndt_omp",
                             "lidarcam_acfr_vlp16", "lidarcam_opencalib_road"}) {
    if (!fs::is_directory(data / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(data / folder)) {
      const std::string suffix = entry.path().extension() == ".pcd" ? "pcd" : "ply";
      if (entry.path().extension() != "." + suffix) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes(std::istreambuf_iterator<char>(file), {});
      const auto cloud = ReadText(bytes, suffix);
      ASSERT_TRUE(cloud) << entry.path() << ": " << Sentence(cloud.error());
      if (cloud->points_m.size() < 256 || cloud->fields.empty()) continue;
      std::vector<Row> rows;
      for (std::size_t i = 0; i < cloud->points_m.size(); ++i) {
        const auto& p = cloud->points_m[i];
        rows.push_back({{p.x(), p.y(), p.z(), cloud->fields[0].values[i], static_cast<double>(i % 64)}});
      }
      rows.resize(rows.size() / 4 * 4);
      EXPECT_TRUE(IsCertain(Pack<float>(rows, 4))) << entry.path();
      for (const std::size_t numbers : {3u, 5u, 6u, 8u})
        EXPECT_FALSE(IsCertain(Pack<float>(rows, numbers))) << entry.path() << " " << numbers;
      EXPECT_FALSE(IsCertain(Pack<double>(rows, 4))) << entry.path();
      ++clouds;
    }
  }
  if (clouds == 0) GTEST_SKIP() << "no clouds in ../shared/data";
}

}  // namespace
}  // namespace rigcal::formats

#include "client/import/files.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "client/import/files/held_folder.h"
#include "client/import/files/session_folder.h"
#include "client/import/report.h"
#include "server/formats/clouds/cloud.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::importing {
namespace {

bags::Image ImageOf(const std::string& encoding, int width, int height, const std::vector<unsigned char>& bytes,
                    bool big_endian = false) {
  bags::Image image;
  image.encoding = encoding;
  image.width_px = width;
  image.height_px = height;
  image.step_bytes = width * bags::PixelBytes(encoding);
  image.big_endian = big_endian;
  image.data = std::as_bytes(std::span(bytes));
  return image;
}
cv::Mat DecodedOf(const bags::Image& image) {
  const auto png = PngOf(image);
  EXPECT_TRUE(png) << png.error().what;
  return cv::imdecode(std::vector<unsigned char>(png->begin(), png->end()), cv::IMREAD_UNCHANGED);
}

TEST(Files, PicturesKeepTheirValues) {
  const std::vector<unsigned char> colour = {10, 20, 30, 40, 50, 60};
  EXPECT_EQ(DecodedOf(ImageOf("bgr8", 2, 1, colour)).at<cv::Vec3b>(0, 1), cv::Vec3b(40, 50, 60));
  EXPECT_EQ(DecodedOf(ImageOf("rgb8", 2, 1, colour)).at<cv::Vec3b>(0, 1), cv::Vec3b(60, 50, 40));
  EXPECT_EQ(DecodedOf(ImageOf("mono8", 3, 2, colour)).at<unsigned char>(1, 2), 60);
  EXPECT_EQ(DecodedOf(ImageOf("mono16", 3, 1, colour)).at<std::uint16_t>(0, 1), 40 * 256 + 30);
  EXPECT_EQ(DecodedOf(ImageOf("16UC1", 3, 1, colour, true)).at<std::uint16_t>(0, 1), 30 * 256 + 40);
}

// A red picture through each pattern: red pixels have the value, the others none.
TEST(Files, BayerPatternsAreReadByTheirNames) {
  constexpr int kSide = 8;
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    std::vector<unsigned char> bytes;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        bytes.push_back(pattern[static_cast<std::size_t>(y % 2 * 2 + x % 2)] == 'r' ? 200 : 0);
    EXPECT_EQ(DecodedOf(ImageOf("bayer_" + pattern + "8", kSide, kSide, bytes)).at<cv::Vec3b>(4, 4),
              cv::Vec3b(0, 0, 200))
        << pattern;
  }
}

TEST(Files, Yuv422HasItsTwoOrders) {
  const auto grey_of = [](const std::string& encoding, const std::vector<unsigned char>& bytes) {
    return DecodedOf(ImageOf(encoding, 2, 1, bytes)).at<cv::Vec3b>(0, 0);
  };
  EXPECT_EQ(grey_of("yuv422", {128, 126, 128, 126}), grey_of("yuv422_yuy2", {126, 128, 126, 128}));
  EXPECT_NEAR(grey_of("yuv422", {128, 126, 128, 126})[1], 128, 2);
}

// Read back by the reader of session folders.
TEST(Files, CloudsKeepEveryField) {
  struct Point {
    float x, y, z;
    std::uint16_t ring;
    std::uint8_t padding[2];
    double time;
  };
  std::vector<Point> points = {{1, 2, 3, 7, {}, 0.25}, {4, 5, 6, 8, {}, 0.5}};
  bags::PointCloud cloud;
  cloud.width = 2;
  cloud.height = 1;
  cloud.point_bytes = sizeof(Point);
  cloud.row_bytes = 2 * sizeof(Point);
  cloud.fields = {{"x", bags::Primitive::kFloat32, 0},
                  {"y", bags::Primitive::kFloat32, 4},
                  {"z", bags::Primitive::kFloat32, 8},
                  {"ring", bags::Primitive::kUint16, 12},
                  {"time", bags::Primitive::kFloat64, 16}};
  cloud.data = std::as_bytes(std::span(points));
  const std::string pcd = PcdOf(cloud);
  const auto read = formats::ReadCloud(std::as_bytes(std::span(pcd)), "pcd", "top/01", std::nullopt);
  ASSERT_TRUE(read) << read.error().what;
  ASSERT_EQ(read->points_m.size(), 2U);
  EXPECT_EQ(read->points_m[1], Eigen::Vector3f(4, 5, 6));
  ASSERT_EQ(read->fields.size(), 2U);
  EXPECT_EQ(read->fields[0].values, (std::vector<double>{7, 8}));
  EXPECT_EQ(read->fields[1].values, (std::vector<double>{0.25, 0.5}));
}

TEST(Files, AScanLiesInItsPlane) {
  bags::LaserScan scan;
  scan.angle_increment_rad = M_PI / 2;
  scan.range_min_m = 0.1;
  scan.range_max_m = 30;
  scan.ranges_m = {1, 2, 100};
  const std::string pcd = PcdOf(scan);
  const auto read = formats::ReadCloud(std::as_bytes(std::span(pcd)), "pcd", "scan/01", std::nullopt);
  ASSERT_TRUE(read) << read.error().what;
  ASSERT_EQ(read->points_m.size(), 2U);  // the third is beyond its range
  EXPECT_NEAR(read->points_m[1].y(), 2, 1e-6);
  EXPECT_NEAR(read->points_m[1].x(), 0, 1e-6);
}

TEST(Files, PosesAreTheShortestNumbers) {
  Se3 T;
  T.p_m = {0.1, -2, 1e-20};
  EXPECT_EQ(PoseColumns(5, T), "5,0.1,-2,1e-20,0,0,0,1\n");
}

TEST(Files, TellHowMuchLargerThanItsMessageAPictureIs) {
  EXPECT_EQ(PngBytesRatio("mono8"), 1);
  EXPECT_EQ(PngBytesRatio("bgr8"), 1);
  EXPECT_EQ(PngBytesRatio("rgba8"), 0.75);
  EXPECT_EQ(PngBytesRatio("bayer_rggb8"), 3);
  EXPECT_EQ(PngBytesRatio("bayer_rggb16"), 3);
  EXPECT_EQ(PngBytesRatio("yuv422"), 1.5);
  EXPECT_EQ(PngBytesRatio("unheard_of"), 1);
}

TEST(Files, AnImportThatDoesNotFitIsRefusedBeforehand) {
  EXPECT_TRUE(CheckRoomOf("visit", 1000, 1000));
  const Status refused = CheckRoomOf("visit", 3'000'000'000, 1'000'000'000);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBusy);
  EXPECT_NE(refused.error().what.find("visit takes up to 3"), std::string::npos) << refused.error().what;
}

TEST(Files, OnlyWhatAnotherImportBeganIsRemoved) {
  const TempFolder temporary;
  const std::filesystem::path folder = temporary.path() / "replaced_import";
  ASSERT_TRUE(SessionFolder::RemoveOther(folder, "one")) << "there is none";
  ASSERT_TRUE(SessionFolder::Begin(folder, "one"));
  ASSERT_TRUE(SessionFolder::RemoveOther(folder, "one"));
  EXPECT_TRUE(std::filesystem::exists(folder)) << "it is the same import";
  ASSERT_TRUE(SessionFolder::RemoveOther(folder, "two"));
  EXPECT_TRUE(std::filesystem::is_empty(folder)) << "itself it stays: it is held";
  std::filesystem::create_directories(folder / "of a person");
  ASSERT_TRUE(SessionFolder::RemoveOther(folder, "two"));
  EXPECT_TRUE(std::filesystem::exists(folder)) << "no import began it";
  std::filesystem::remove_all(folder);
}

// Name, size, ends and time of writing are the same, as of a damaged bag and its good copy made by `cp -p`.
TEST(Files, ACopyOfABagIsKnownByItsBytes) {
  namespace fs = std::filesystem;
  const TempFolder temporary;
  const fs::path bag = temporary.path() / "drive.mcap", folder = temporary.path() / "visit";
  const auto write = [&](char middle) {
    fs::remove(bag);
    std::ofstream(bag, std::ios::binary) << std::string(1 << 20, 'x') << middle << std::string(1 << 20, 'x');
    fs::last_write_time(bag, fs::file_time_type() + std::chrono::seconds(1));
  };
  write('a');
  const auto begun = SessionFolder::Begin(folder, "one");
  ASSERT_TRUE(begun);
  std::int64_t read_bytes = 0;
  const auto takes = [&] {
    read_bytes = 0;
    const auto same = begun->TakeBag(bag, [&](std::int64_t done, std::int64_t) { read_bytes = done; });
    return same && *same;
  };
  EXPECT_TRUE(takes());
  EXPECT_EQ(read_bytes, (2 << 20) + 1);
  EXPECT_TRUE(takes());
  EXPECT_EQ(read_bytes, 0) << "it is known without";
  write('b');
  EXPECT_FALSE(takes());
  EXPECT_FALSE(takes()) << "what is there stays the other's";
  write('a');
  EXPECT_TRUE(takes()) << "another copy of the same bytes";
  EXPECT_GT(read_bytes, 0);
  EXPECT_TRUE(takes());
  EXPECT_EQ(read_bytes, 0);
}

TEST(Files, AFinishedImportOfAnOlderVersionIsTakenAsItIs) {
  const TempFolder temporary;
  const std::filesystem::path bag = temporary.path() / "drive.mcap", folder = temporary.path() / "visit";
  std::ofstream(bag) << "bytes";
  const auto begun = SessionFolder::Begin(folder, "one");
  ASSERT_TRUE(begun && begun->Finish("format: 1\n", "{}"));
  const auto same = begun->TakeBag(bag, {});
  EXPECT_TRUE(same && *same);
}

TEST(Files, AnImportThatEndedAmidItsRecordGoesOn) {
  const TempFolder temporary;
  const std::filesystem::path folder = temporary.path() / "unfinished_record";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / ".rigcal-import.json.tmp-123-0") << "{";
  const auto begun = SessionFolder::Begin(folder, "one");
  EXPECT_TRUE(begun) << begun.error().what;
  EXPECT_FALSE(std::filesystem::exists(folder / ".rigcal-import.json.tmp-123-0"));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "of a person.tmp-123-0") << "{";
  EXPECT_FALSE(SessionFolder::Begin(folder, "one"));
  std::filesystem::remove_all(folder);
}

TEST(Files, AFolderIsHeldByOneAtATime) {
  const TempFolder temporary;
  const std::filesystem::path folder = temporary.path() / "held" / "session";
  {
    const auto first = HeldFolder::Take(folder);
    ASSERT_TRUE(first) << first.error().what;
    const auto second = HeldFolder::Take(folder);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::kConflict);
    EXPECT_NE(second.error().what.find("is in use by another import or push"), std::string::npos)
        << second.error().what;
  }
  EXPECT_FALSE(std::filesystem::exists(folder)) << "made for it, and nothing came in";
  std::filesystem::create_directories(folder);
  { ASSERT_TRUE(HeldFolder::Take(folder)); }
  EXPECT_TRUE(std::filesystem::exists(folder)) << "it was there";
  {
    const auto held = HeldFolder::Take(folder);
    ASSERT_TRUE(held);
    std::filesystem::remove_all(folder);
    EXPECT_TRUE(HeldFolder::Take(folder)) << "what was removed is held by nobody";
  }
}

TEST(Files, WhatBecameOfTheBagIsKeptForWhoGoesOn) {
  ImportOutcome outcome;
  outcome.captures = 5;
  outcome.tolerance_ns = 5'000'000;
  outcome.sensors.resize(1);
  outcome.sensors[0].id = "left";
  outcome.sensors[0].topic = "/left";
  outcome.sensors[0].messages = 9;
  outcome.sensors[0].written = 5;
  outcome.sensors[0].refused = 2;
  outcome.sensors[0].first_refusal = "its picture is no picture";
  outcome.sensors[0].use.without_partner = 1;
  outcome.sensors[0].use.repeated_stamp = 1;
  outcome.damage = {{ErrorCode::kInvalidInput, "a.mcap is cut off", "Record it again."}};
  const auto read = ReadOutcome(OutcomeJson(outcome, ""));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(OutcomeJson(*read, "here"), OutcomeJson(outcome, "here"));
  EXPECT_EQ(read->damage[0].cure, "Record it again.");
  EXPECT_EQ(read->sensors[0].refused, 2);
  const auto damaged = ReadOutcome("{\"captures\":-1}");
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace rigcal::importing

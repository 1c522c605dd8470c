// The recorded clouds beside the project, all of them.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/unit/formats/clouds/cloud_samples.h"
#include "tests/unit/recordings.h"

namespace rigcal::formats {
namespace {

namespace fs = std::filesystem;

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> CloudsIn(const std::string& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(Recording(folder)))
    if (entry.path().extension() == ".pcd" || entry.path().extension() == ".ply") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

// The number behind `key` in the header.
std::size_t Claimed(const std::string& bytes, const std::string& key) {
  return std::stoul(bytes.substr(bytes.find("\n" + key + " ") + key.size() + 2, 12));
}

class RecordedClouds : public testing::TestWithParam<std::pair<const char*, std::size_t>> {};

TEST_P(RecordedClouds, HaveThePointsOfTheirHeaders) {
  const auto [folder, count] = GetParam();
  RIGCAL_SKIP_WITHOUT_RECORDING(folder);
  const auto paths = CloudsIn(folder);
  EXPECT_EQ(paths.size(), count);
  for (const fs::path& path : paths) {
    const std::string suffix = path.extension().string().substr(1), bytes = BytesOf(path);
    const auto cloud = ReadText(bytes, suffix);
    ASSERT_TRUE(cloud) << path << ": " << Sentence(cloud.error());
    EXPECT_EQ(cloud->points_m.size() + cloud->dropped, Claimed(bytes, suffix == "pcd" ? "POINTS" : "element vertex"))
        << path;
    EXPECT_EQ(cloud->left_out, std::vector<std::string>()) << path;
    ASSERT_FALSE(cloud->fields.empty()) << path;
    for (const CloudField& field : cloud->fields) EXPECT_EQ(field.values.size(), cloud->points_m.size()) << path;
  }
}

INSTANTIATE_TEST_SUITE_P(Data, RecordedClouds,
                         testing::Values(std::pair("lidarcam_acfr_vlp16/pcd", 40),
                                         std::pair("lidarlidar_small_gicp", 2), std::pair("lidarcam_opencalib_road", 2),
                                         std::pair("lidarlidar_opencalib", 3)));

TEST(RecordedCloud, FirstAndLastLineOfText) {
  RIGCAL_SKIP_WITHOUT_RECORDING("lidarcam_acfr_vlp16");
  const std::string bytes = BytesOf(Recording("lidarcam_acfr_vlp16/pcd/pose1_full.pcd"));
  const auto cloud = ReadText(bytes, "pcd");
  ASSERT_TRUE(cloud) << Sentence(cloud.error());
  EXPECT_EQ(cloud->points_m.size(), 23969u);
  double x = 0, y = 0, z = 0, intensity = 0, ring = 0;
  const std::size_t body = bytes.find("DATA ascii\n") + 11;
  ASSERT_EQ(std::sscanf(bytes.c_str() + body, "%lf %lf %lf %lf %lf", &x, &y, &z, &intensity, &ring), 5);
  EXPECT_TRUE(cloud->points_m.front().isApprox(Eigen::Vector3d(x, y, z).cast<float>()));
  EXPECT_EQ(cloud->fields.at(0).values.front(), intensity);
  EXPECT_EQ(cloud->fields.at(1).values.front(), ring);
  EXPECT_LT(*std::max_element(cloud->fields[1].values.begin(), cloud->fields[1].values.end()), 16.0);
}

}  // namespace
}  // namespace rigcal::formats

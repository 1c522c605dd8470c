// Clouds as PCL writes them, read with our decoders.
#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "server/formats/clouds/cloud.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::formats {
namespace {

constexpr std::uint32_t kPoints = 60;
using Types = pcl::PCLPointField;

template <typename T>
void Put(pcl::PCLPointCloud2& cloud, std::uint32_t point, std::uint32_t field, std::uint32_t k, T value) {
  std::memcpy(&cloud.data[point * cloud.point_step + cloud.fields[field].offset + k * sizeof(T)], &value, sizeof(T));
}

pcl::PCLPointCloud2 CloudOf(std::initializer_list<pcl::PCLPointField> fields, std::uint32_t point_step) {
  pcl::PCLPointCloud2 cloud;
  cloud.fields = fields;
  cloud.height = 3;
  cloud.width = kPoints / cloud.height;
  cloud.point_step = point_step;
  cloud.row_step = point_step * cloud.width;
  cloud.data.resize(kPoints * point_step);
  return cloud;
}

pcl::PCLPointField FieldOf(const char* name, std::uint32_t offset, std::uint8_t type, std::uint32_t count = 1) {
  pcl::PCLPointField field;
  field.name = name, field.offset = offset, field.datatype = type, field.count = count;
  return field;
}

double Expected(std::uint32_t point, std::uint32_t field) {
  return (point * 7 + field * 13) % 100 - (field % 2) * 20.0;
}

// x y z, a gap of four bytes, and one field of each type; point 4 has no return.
pcl::PCLPointCloud2 EveryType() {
  auto cloud = CloudOf(
      {FieldOf("x", 0, Types::FLOAT32), FieldOf("y", 4, Types::FLOAT32), FieldOf("z", 8, Types::FLOAT32),
       FieldOf("i1", 16, Types::INT8), FieldOf("u1", 17, Types::UINT8), FieldOf("i2", 18, Types::INT16),
       FieldOf("u2", 20, Types::UINT16), FieldOf("i4", 22, Types::INT32), FieldOf("u4", 26, Types::UINT32),
       FieldOf("f4", 30, Types::FLOAT32), FieldOf("f8", 34, Types::FLOAT64), FieldOf("more", 42, Types::FLOAT32, 3)},
      54);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) Put(cloud, i, axis, 0, static_cast<float>(0.1 * Expected(i, axis)));
    Put(cloud, i, 3, 0, static_cast<std::int8_t>(Expected(i, 3)));
    Put(cloud, i, 4, 0, static_cast<std::uint8_t>(Expected(i, 4)));
    Put(cloud, i, 5, 0, static_cast<std::int16_t>(Expected(i, 5)));
    Put(cloud, i, 6, 0, static_cast<std::uint16_t>(Expected(i, 6)));
    Put(cloud, i, 7, 0, static_cast<std::int32_t>(Expected(i, 7)));
    Put(cloud, i, 8, 0, static_cast<std::uint32_t>(Expected(i, 8)));
    Put(cloud, i, 9, 0, static_cast<float>(Expected(i, 9)));
    Put(cloud, i, 10, 0, Expected(i, 10));
    for (std::uint32_t k = 0; k < 3; ++k) Put(cloud, i, 11, k, static_cast<float>(Expected(i, 11 + k)));
  }
  Put(cloud, 4, 1, 0, std::numeric_limits<float>::quiet_NaN());
  return cloud;
}

class Pcl : public testing::Test {
 protected:
  std::string Path(const std::string& suffix) const { return (folder_.path() / ("cloud." + suffix)).string(); }
  Result<Cloud> Read(const std::string& suffix) const {
    std::ifstream file(Path(suffix), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    return ReadCloud(std::as_bytes(std::span(bytes)), suffix, "cloud." + suffix);
  }

  TempFolder folder_;
};

void ExpectEveryType(const Result<Cloud>& cloud) {
  ASSERT_TRUE(cloud) << Sentence(cloud.error());
  ASSERT_EQ(cloud->points_m.size(), kPoints - 1);
  EXPECT_EQ(cloud->dropped, 1u);
  ASSERT_EQ(cloud->fields.size(), 11u);
  const char* names[] = {"i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8", "more_0", "more_1", "more_2"};
  for (std::uint32_t f = 0; f < 11; ++f) EXPECT_EQ(cloud->fields[f].name, names[f]);
  for (std::uint32_t at = 0; at < kPoints - 1; ++at) {
    const std::uint32_t i = at < 4 ? at : at + 1;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      EXPECT_FLOAT_EQ(cloud->points_m[at][axis], static_cast<float>(0.1 * Expected(i, axis)));
    for (std::uint32_t f = 0; f < 11; ++f) EXPECT_EQ(cloud->fields[f].values[at], Expected(i, f + 3)) << names[f];
  }
}

TEST_F(Pcl, PcdAscii) {
  ASSERT_EQ(pcl::PCDWriter().writeASCII(Path("pcd"), EveryType()), 0);
  ExpectEveryType(Read("pcd"));
}

TEST_F(Pcl, PcdBinary) {
  ASSERT_EQ(pcl::PCDWriter().writeBinary(Path("pcd"), EveryType()), 0);
  ExpectEveryType(Read("pcd"));
}

TEST_F(Pcl, PcdBinaryCompressed) {
  ASSERT_EQ(pcl::PCDWriter().writeBinaryCompressed(Path("pcd"), EveryType()), 0);
  ExpectEveryType(Read("pcd"));
}

// PCL's PLY has a camera element after the vertices where it is asked to.
class PclPly : public Pcl, public testing::WithParamInterface<std::pair<bool, bool>> {};

TEST_P(PclPly, Reads) {
  auto cloud =
      CloudOf({FieldOf("x", 0, Types::FLOAT32), FieldOf("y", 4, Types::FLOAT32), FieldOf("z", 8, Types::FLOAT32),
               FieldOf("intensity", 12, Types::FLOAT32), FieldOf("ring", 16, Types::UINT16)},
              18);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    for (std::uint32_t f = 0; f < 4; ++f) Put(cloud, i, f, 0, static_cast<float>(0.25 * Expected(i, f)));
    Put(cloud, i, 4, 0, static_cast<std::uint16_t>(Expected(i, 4)));
  }
  const auto [is_binary, has_camera] = GetParam();
  ASSERT_EQ(pcl::PLYWriter().write(Path("ply"), cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity(),
                                   is_binary, has_camera),
            0);
  const auto read = Read("ply");
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->points_m.size(), kPoints);
  ASSERT_EQ(read->fields.size(), 2u);
  EXPECT_EQ(read->fields[0].name, "intensity");
  EXPECT_EQ(read->fields[1].name, "ring");
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) EXPECT_EQ(read->points_m[i][axis], 0.25 * Expected(i, axis));
    EXPECT_EQ(read->fields[0].values[i], 0.25 * Expected(i, 3));
    EXPECT_EQ(read->fields[1].values[i], Expected(i, 4));
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, PclPly,
                         testing::Values(std::pair(false, false), std::pair(false, true), std::pair(true, false),
                                         std::pair(true, true)));

}  // namespace
}  // namespace rigcal::formats

// Points of lidars, and scans in one plane.
#pragma once

#include <string>
#include <vector>

#include "client/bags/messages/header.h"

namespace rigcal::bags {

// A number that each point has, at its place in the point's bytes.
struct PointField {
  std::string name;  // as sent: "x", "intensity", "ring", "t", ...
  Primitive type = Primitive::kFloat32;
  std::size_t offset_bytes = 0;
  std::size_t count = 1;  // of numbers
};

// Points as they were sent, whatever their layout; checked against the size that is claimed.
struct PointCloud {
  Header header;
  std::size_t width = 0, height = 0;  // points of a row, rows: width * height is 1 to kCloudPointsMax
  std::vector<PointField> fields;     // by offset; x, y and z are among them
  std::size_t point_bytes = 0, row_bytes = 0;
  bool big_endian = false;
  Bytes data;  // points into the message
};
// kInvalidInput: no points, no x y z, fields beyond the point's bytes, fewer bytes than points. PointCloud2 alone.
[[nodiscard]] Result<PointCloud> ReadPointCloud(const Value& message);

// Ranges in the x y plane of the sensor, from the first angle on, counter-clockwise.
struct LaserScan {
  Header header;
  double angle_min_rad = 0, angle_increment_rad = 0, time_increment_s = 0, range_min_m = 0, range_max_m = 0;
  std::vector<float> ranges_m;     // beyond the limits or not finite: no return
  std::vector<float> intensities;  // as many, or none
};
// kInvalidInput: angles that are not finite, other counts.
[[nodiscard]] Result<LaserScan> ReadLaserScan(const Value& message);

}  // namespace rigcal::bags

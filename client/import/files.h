// What a sensor sent, as a file of a session folder.
#pragma once

#include <string>
#include <vector>

#include "client/bags/messages/cloud.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "server/detect/pictures/grey_image.h"

namespace rigcal::importing {

// The pixels of a picture, away from the message that they came in.
struct Pixels {
  bags::Image image;
  std::vector<std::byte> data;  // image.data points into it
};
// The message may go.
[[nodiscard]] Pixels CopyOf(const bags::Image& image);
// A PNG that holds the same values: grey ones of 8 or 16 bits, else BGR; Bayer patterns and YUV become BGR. The error
// names what of it cannot be done. Any thread.
[[nodiscard]] Result<std::string> PngOf(const bags::Image& image);

// The same in grey of 8 bits, for detection; 16 bits are stretched between the darkest and the brightest. Any thread.
[[nodiscard]] Result<detect::GreyImage> GreyOf(const bags::Image& image);

// Bytes of that picture's pixels to those of the message's: 3 of a Bayer pattern, 1 of grey. 1 of what is not read.
[[nodiscard]] double PngBytesRatio(const std::string& encoding);

// A binary PCD with every field that the cloud has, x y z and others by their names, in the machine's byte order;
// padding is left out. Values as they were sent, NaN too.
[[nodiscard]] std::string PcdOf(const bags::PointCloud& cloud);
// The points of a scan, z = 0; beams without a return as NaN, so that the beam's number stays its place.
[[nodiscard]] std::string PcdOf(const bags::LaserScan& scan);

// A row of poses.csv behind its first column: numbers in the shortest form that reads back as the same.
[[nodiscard]] std::string PoseColumns(std::int64_t stamp_ns, const Se3& T_world_body);

}  // namespace rigcal::importing

// Pictures and what their driver says of the camera.
#pragma once

#include <string>
#include <vector>

#include "client/bags/messages/header.h"

namespace rigcal::bags {

// Rows of pixels as they were sent, checked against the size that is claimed.
struct Image {
  Header header;
  int width_px = 0, height_px = 0;  // 1 to kPictureSideMax
  std::string encoding;             // "bgr8", "mono16", ...: sensor_msgs/image_encodings
  int step_bytes = 0;               // from one row to the next
  bool big_endian = false;          // of values of 16 bits
  Bytes data;                       // step_bytes * height_px at least; points into the message
};
// Bytes of one pixel of an encoding that is read: mono8, mono16, 8UC1, 8UC3, 16UC1, bgr8, rgb8, bgra8, rgba8, bayer_*8,
// bayer_*16, yuv422 (uyvy), yuv422_yuy2 (yuyv). 0 of any other.
[[nodiscard]] int PixelBytes(std::string_view encoding);
// kUnsupported, by name: an encoding that is not read. kInvalidInput: no pixels, fewer bytes than rows.
[[nodiscard]] Result<Image> ReadImage(const Value& message);

// A whole file of a picture.
struct CompressedImage {
  Header header;
  std::string suffix;  // "jpg" or "png": by its first bytes, not by what `format` claims
  Bytes data;
};
// kUnsupported, by name: depth pictures, and files that are neither JPEG nor PNG.
[[nodiscard]] Result<CompressedImage> ReadCompressedImage(const Value& message);

struct CameraInfo {
  Header header;
  int width_px = 0, height_px = 0;                    // 0: not calibrated
  std::string distortion_model;                       // "plumb_bob", "rational_polynomial", "equidistant", ...
  std::vector<double> distortion;                     // in the model's order
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;  // 0: not calibrated
};
// kInvalidInput: values that are not finite, or not all there.
[[nodiscard]] Result<CameraInfo> ReadCameraInfo(const Value& message);

}  // namespace rigcal::bags

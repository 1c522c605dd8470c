#include "client/bags/messages/image.h"

#include <cmath>
#include <map>

#include "client/bags/cursor.h"
#include "client/bags/limits.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr const char* kEncodings = "mono8, mono16, 16UC1, bgr8, rgb8, bgra8, rgba8, bayer patterns and yuv422 are read";
constexpr std::size_t kDistortionMax = 16;

bool IsSide(std::int64_t side_px) { return side_px >= 1 && side_px <= limits::kPictureSideMax; }

}  // namespace

int PixelBytes(std::string_view encoding) {
  static const std::map<std::string_view, int> kBytes = {
      {"mono8", 1},  {"8UC1", 1},  {"bayer_rggb8", 1},  {"bayer_bggr8", 1},  {"bayer_gbrg8", 1},  {"bayer_grbg8", 1},
      {"mono16", 2}, {"16UC1", 2}, {"bayer_rggb16", 2}, {"bayer_bggr16", 2}, {"bayer_gbrg16", 2}, {"bayer_grbg16", 2},
      {"yuv422", 2}, {"uyvy", 2},  {"yuv422_yuy2", 2},  {"yuyv", 2},         {"bgr8", 3},         {"rgb8", 3},
      {"8UC3", 3},   {"bgra8", 4}, {"rgba8", 4}};
  const auto found = kBytes.find(encoding);
  return found == kBytes.end() ? 0 : found->second;
}

Result<Image> ReadImage(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  const std::int64_t width = message["width"].Integer(), height = message["height"].Integer(),
                     step = message["step"].Integer();
  if (!header) return RefuseMessage("the picture has no header");
  Image image;
  image.header = *header;
  image.encoding = message["encoding"].Text();
  if (!IsSide(width) || !IsSide(height))
    return RefuseMessage("the picture has " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  const std::int64_t pixel = PixelBytes(image.encoding);
  if (pixel == 0)
    return Fail(ErrorCode::kUnsupported, "the picture is encoded as " + Quoted(image.encoding) + "; " + kEncodings,
                "Record the camera's other topic, or convert it.");
  image.data = message["data"].bytes();
  if (step < width * pixel || step > static_cast<std::int64_t>(limits::kRecordBytesMax) ||
      static_cast<std::int64_t>(image.data.size()) < step * (height - 1) + width * pixel)
    return RefuseMessage("the picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels as " +
                         Quoted(image.encoding) + " has " + std::to_string(image.data.size()) + " bytes in rows of " +
                         std::to_string(step));
  if (pixel == 2 && image.encoding[0] != 'b' && image.encoding.find("16") == std::string::npos && width % 2 != 0)
    return RefuseMessage("the picture as " + Quoted(image.encoding) + " has an odd width");
  image.width_px = static_cast<int>(width);
  image.height_px = static_cast<int>(height);
  image.step_bytes = static_cast<int>(step);
  image.big_endian = message["is_bigendian"].Integer() != 0;
  return image;
}

Result<CompressedImage> ReadCompressedImage(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  if (!header) return RefuseMessage("the picture has no header");
  CompressedImage image;
  image.header = *header;
  image.data = message["data"].bytes();
  const std::string_view begins = TextOf(image.data).substr(0, 8);
  if (begins.rfind("\xFF\xD8\xFF", 0) == 0) image.suffix = "jpg";
  if (begins == "\x89PNG\r\n\x1A\n") image.suffix = "png";
  if (!image.suffix.empty()) return image;
  return Fail(ErrorCode::kUnsupported,
              "the picture is compressed as " + Quoted(message["format"].Text()) + " and is neither JPEG nor PNG",
              "Record the camera's uncompressed topic.");
}

Result<CameraInfo> ReadCameraInfo(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  const Value &k = message.Either("k", "K"), &d = message.Either("d", "D");
  if (!header || k.count() != 9 || d.count() > kDistortionMax) return RefuseMessage("the camera info is not whole");
  CameraInfo info;
  info.header = *header;
  const std::int64_t width = message["width"].Integer(), height = message["height"].Integer();
  info.width_px = IsSide(width) ? static_cast<int>(width) : 0;
  info.height_px = IsSide(height) ? static_cast<int>(height) : 0;
  info.distortion_model = message["distortion_model"].Text();
  for (std::size_t i = 0; i < d.count(); ++i) info.distortion.push_back(d.RealAt(i));
  info.fx_px = k.RealAt(0);
  info.fy_px = k.RealAt(4);
  info.cx_px = k.RealAt(2);
  info.cy_px = k.RealAt(5);
  bool finite = std::isfinite(info.fx_px + info.fy_px + info.cx_px + info.cy_px);
  for (const double value : info.distortion) finite = finite && std::isfinite(value);
  if (!finite) return RefuseMessage("the camera info has values that are not finite");
  return info;
}

}  // namespace rigcal::bags

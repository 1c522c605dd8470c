#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "client/import/files.h"
#include "server/base/process/out_of_memory.h"

namespace rigcal::importing {
namespace {

// How OpenCV gets BGR from it; it names a Bayer pattern by the second row of it, read from the second column.
const std::map<std::string, int>& Conversions() {
  static const std::map<std::string, int> kConversions = {{"rgb8", cv::COLOR_RGB2BGR},
                                                          {"bgra8", cv::COLOR_BGRA2BGR},
                                                          {"rgba8", cv::COLOR_RGBA2BGR},
                                                          {"bayer_rggb8", cv::COLOR_BayerBG2BGR},
                                                          {"bayer_bggr8", cv::COLOR_BayerRG2BGR},
                                                          {"bayer_gbrg8", cv::COLOR_BayerGR2BGR},
                                                          {"bayer_grbg8", cv::COLOR_BayerGB2BGR},
                                                          {"bayer_rggb16", cv::COLOR_BayerBG2BGR},
                                                          {"bayer_bggr16", cv::COLOR_BayerRG2BGR},
                                                          {"bayer_gbrg16", cv::COLOR_BayerGR2BGR},
                                                          {"bayer_grbg16", cv::COLOR_BayerGB2BGR},
                                                          {"yuv422", cv::COLOR_YUV2BGR_UYVY},
                                                          {"uyvy", cv::COLOR_YUV2BGR_UYVY},
                                                          {"yuv422_yuy2", cv::COLOR_YUV2BGR_YUY2},
                                                          {"yuyv", cv::COLOR_YUV2BGR_YUY2}};
  return kConversions;
}

bool HasWords(const std::string& encoding) { return encoding.find("16") != std::string::npos; }

int TypeOf(const std::string& encoding) {
  if (HasWords(encoding)) return CV_16UC1;
  return CV_8UC(bags::PixelBytes(encoding));
}

cv::Mat MatOf(const bags::Image& image) {
  auto* pixels = const_cast<std::byte*>(image.data.data());  // read only, as OpenCV cannot say
  return {image.height_px, image.width_px, TypeOf(image.encoding), pixels, static_cast<std::size_t>(image.step_bytes)};
}

cv::Mat Swapped(const cv::Mat& words) {
  cv::Mat swapped = words.clone();
  swapped.forEach<std::uint16_t>(
      [](std::uint16_t& word, const int*) { word = static_cast<std::uint16_t>(word << 8 | word >> 8); });
  return swapped;
}

// Grey, or BGR; of as many bits as it has. Points into `image` where nothing is to be changed.
cv::Mat ColourOf(const bags::Image& image) {
  cv::Mat mat = MatOf(image);
  if (HasWords(image.encoding) && image.big_endian) mat = Swapped(mat);
  const auto conversion = Conversions().find(image.encoding);
  if (conversion == Conversions().end()) return mat;
  cv::Mat bgr;
  cv::cvtColor(mat, bgr, conversion->second);
  return bgr;
}

template <typename Made, typename Work>
Result<Made> WithoutExceptions(const std::string& what, const Work& work) {
  try {
    return work();
  } catch (const std::exception& failure) {
    if (IsOutOfMemory(failure))
      return Fail(ErrorCode::kBusy, "there is no memory for a picture",
                  "Close other programs and go on with the same command.");
    return bags::RefuseMessage("the picture cannot be " + what + ": " + failure.what());
  }
}

}  // namespace

Pixels CopyOf(const bags::Image& image) {
  Pixels pixels{image, std::vector<std::byte>(image.data.begin(), image.data.end())};
  pixels.image.data = pixels.data;
  return pixels;
}

double PngBytesRatio(const std::string& encoding) {
  if (Conversions().count(encoding) == 0) return 1;
  return 3.0 * (HasWords(encoding) ? 2 : 1) / bags::PixelBytes(encoding);
}

Result<std::string> PngOf(const bags::Image& image) {
  return WithoutExceptions<std::string>("written as PNG", [&]() -> Result<std::string> {
    std::vector<unsigned char> png;
    if (!cv::imencode(".png", ColourOf(image), png, {cv::IMWRITE_PNG_COMPRESSION, 1}))
      return bags::RefuseMessage("the picture cannot be written as PNG");
    return std::string(png.begin(), png.end());
  });
}

Result<detect::GreyImage> GreyOf(const bags::Image& image) {
  return WithoutExceptions<detect::GreyImage>("looked at", [&]() -> Result<detect::GreyImage> {
    cv::Mat mat = ColourOf(image), grey;
    if (mat.channels() == 3) cv::cvtColor(mat, grey, cv::COLOR_BGR2GRAY);
    if (mat.channels() == 1) grey = mat;
    if (grey.depth() != CV_8U) cv::normalize(grey, grey, 0, 255, cv::NORM_MINMAX, CV_8U);
    detect::GreyImage found{grey.cols, grey.rows, std::vector<std::uint8_t>(grey.total())};
    grey.copyTo(cv::Mat(grey.rows, grey.cols, CV_8UC1, found.pixels.data()));
    return found;
  });
}

}  // namespace rigcal::importing

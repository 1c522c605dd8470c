#include "server/detect/pictures/grey_image.h"

#include <algorithm>
#include <cerrno>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "server/base/process/out_of_memory.h"
#include "server/detect/pictures/image_header.h"

namespace rigcal::detect {
namespace {

// The value below which `fraction` of the counts lie.
int Quantile(const std::vector<std::int64_t>& histogram, std::int64_t total, double fraction) {
  const auto wanted = static_cast<std::int64_t>(fraction * static_cast<double>(total));
  std::int64_t seen = 0;
  for (std::size_t value = 0; value < histogram.size(); ++value) {
    seen += histogram[value];
    if (seen > wanted) return static_cast<int>(value);
  }
  return static_cast<int>(histogram.size()) - 1;
}

// Quantiles rather than extremes: one hot pixel must not darken the whole picture, and cameras with 10 or 12 bits
// leave the upper part of the range empty.
cv::Mat Stretched(const cv::Mat& deep) {
  std::vector<std::int64_t> histogram(65536, 0);
  for (int y = 0; y < deep.rows; ++y)
    for (int x = 0; x < deep.cols; ++x) ++histogram[deep.at<std::uint16_t>(y, x)];
  const auto total = static_cast<std::int64_t>(deep.total());
  const int low = Quantile(histogram, total, 0.001);
  const int high = std::max(low + 1, Quantile(histogram, total, 0.999));
  const double scale = 255.0 / (high - low);
  cv::Mat grey;
  deep.convertTo(grey, CV_8U, scale, -scale * low);
  return grey;
}

tl::unexpected<Error> Undecodable() {
  return Fail(ErrorCode::kInvalidInput, "the picture cannot be decoded", "save or copy the picture again");
}

// Decoders allocate, and a progressive JPEG's even fills, what the size claims, however little follows. The most pixels
// that a byte can stand for: PNG at one bit per pixel and deflate's 1032 : 1; JPEG at one bit per block of 8 x 8.
Status CheckPlausible(std::span<const std::byte> encoded, const ImageSize& claimed) {
  constexpr std::int64_t kPngPixelsPerByteMax = 8 * 1032, kJpegPixelsPerByteMax = 8 * 64;
  const bool is_png = encoded[0] == std::byte{0x89};
  const auto bytes = static_cast<std::int64_t>(encoded.size());
  if (claimed.width_px * claimed.height_px <= bytes * (is_png ? kPngPixelsPerByteMax : kJpegPixelsPerByteMax))
    return {};
  return Fail(ErrorCode::kInvalidInput,
              "the picture claims " + std::to_string(claimed.width_px) + " x " + std::to_string(claimed.height_px) +
                  " pixels, which its " + std::to_string(bytes) + " bytes cannot hold",
              "save or copy the picture again");
}

cv::Mat Decoded(std::span<const std::byte> encoded, cv::ImreadModes colour) {
  // imdecode only reads, yet its wrapper for memory takes a mutable pointer.
  auto* bytes = const_cast<std::byte*>(encoded.data());
  const cv::Mat buffer(1, static_cast<int>(encoded.size()), CV_8U, bytes);
  errno = 0;
  cv::Mat decoded = cv::imdecode(buffer, colour | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  // OpenCV keeps to itself what its decoders threw; malloc leaves word.
  if (decoded.empty() && errno == ENOMEM) throw std::bad_alloc();
  return decoded;
}

Result<GreyImage> AsGrey(const cv::Mat& decoded, const ImageSize& claimed) {
  if (decoded.empty() || decoded.channels() != 1) return Undecodable();
  if (ImageSize{decoded.cols, decoded.rows} != claimed) return Undecodable();
  const cv::Mat grey = decoded.depth() == CV_16U ? Stretched(decoded) : decoded;
  if (grey.type() != CV_8U) return Undecodable();
  GreyImage image{grey.cols, grey.rows, {}};
  image.pixels.reserve(grey.total());
  for (int y = 0; y < grey.rows; ++y) image.pixels.insert(image.pixels.end(), grey.ptr(y), grey.ptr(y) + grey.cols);
  return image;
}

// All three colours by one stretch, so that the hue stays.
Result<Picture> AsColour(const cv::Mat& decoded, const ImageSize& claimed) {
  if (decoded.empty() || decoded.channels() != 3) return Undecodable();
  if (ImageSize{decoded.cols, decoded.rows} != claimed) return Undecodable();
  const cv::Mat bgr = decoded.depth() == CV_16U ? Stretched(decoded.reshape(1)).reshape(3) : decoded;
  if (bgr.type() != CV_8UC3) return Undecodable();
  Picture picture{bgr.cols, bgr.rows, std::vector<std::uint8_t>(3 * bgr.total())};
  cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, picture.rgb.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return picture;
}

template <typename Image>
Result<Image> Decode(std::span<const std::byte> encoded, cv::ImreadModes colour,
                     Result<Image> (*as_image)(const cv::Mat&, const ImageSize&)) {
  RIGCAL_ASSIGN(const ImageSize claimed, ReadImageSize(encoded));
  if (encoded.size() > static_cast<std::size_t>(INT32_MAX)) return Undecodable();
  RIGCAL_TRY(CheckPlausible(encoded, claimed));
  if (IsCutOff(encoded))
    return Fail(ErrorCode::kInvalidInput, "the picture is cut off", "save or copy the picture again");
  try {
    return as_image(Decoded(encoded, colour), claimed);
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw std::bad_alloc();
    return Undecodable();
  }
}

}  // namespace

double GreyImage::Between(double x, double y) const {
  x = std::clamp(x, 0.0, width_px - 1.0), y = std::clamp(y, 0.0, height_px - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, width_px - 1), y1 = std::min(y0 + 1, height_px - 1);
  const double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * At(x0, y0) + fx * At(x1, y0)) + fy * ((1 - fx) * At(x0, y1) + fx * At(x1, y1));
}

Result<GreyImage> DecodeGrey(std::span<const std::byte> encoded) {
  return Decode<GreyImage>(encoded, cv::IMREAD_GRAYSCALE, AsGrey);
}

Result<Picture> DecodeColour(std::span<const std::byte> encoded) {
  return Decode<Picture>(encoded, cv::IMREAD_COLOR, AsColour);
}

}  // namespace rigcal::detect

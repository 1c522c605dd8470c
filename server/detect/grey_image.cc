#include "server/detect/grey_image.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "server/detect/image_header.h"

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

cv::Mat Decoded(std::span<const std::byte> encoded) {
  // imdecode only reads, yet its wrapper for memory takes a mutable pointer.
  auto* bytes = const_cast<std::byte*>(encoded.data());
  const cv::Mat buffer(1, static_cast<int>(encoded.size()), CV_8U, bytes);
  return cv::imdecode(buffer, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
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

}  // namespace

Result<GreyImage> DecodeGrey(std::span<const std::byte> encoded) {
  RIGCAL_ASSIGN(const ImageSize claimed, ReadImageSize(encoded));
  if (encoded.size() > static_cast<std::size_t>(INT32_MAX)) return Undecodable();
  try {
    return AsGrey(Decoded(encoded), claimed);
  } catch (const std::exception&) {  // cv::Exception and bad_alloc: both mean that this picture gives no pixels
    return Undecodable();
  }
}

}  // namespace rigcal::detect

#include "server/detect/board.h"

#include <opencv2/core/version.hpp>

#include "server/detect/annotate.h"
#include "server/detect/corners.h"
#include "server/detect/grey_image.h"
#include "server/detect/orientation.h"

namespace rigcal::detect {
namespace {

constexpr int kInnerMin = 3, kInnerMax = 256;  // what the search supports, and a bound on its work

std::string Counts(const Checkerboard& board) {
  return std::to_string(board.inner_cols) + " x " + std::to_string(board.inner_rows);
}

// Empty: it can. Otherwise why not.
std::string WhyUnsearchable(const Checkerboard& board) {
  for (const int count : {board.inner_cols, board.inner_rows})
    if (count < kInnerMin || count > kInnerMax)
      return "a board of " + Counts(board) + " inner corners cannot be searched; both counts must be 3 to 256";
  if (board.inner_cols % 2 == board.inner_rows % 2)
    return "a board of " + Counts(board) + " inner corners looks the same turned round; use one odd and one even count";
  return {};
}

void FindBoard(const GreyImage& image, const Checkerboard& board, BoardView& view) {
  const auto found = FindCorners(image, board.inner_cols, board.inner_rows);
  if (!found) {
    view.why_not = "no " + Counts(board) + " board in the picture; show the whole board, sharp and evenly lit";
    return;
  }
  auto oriented = Oriented(image, board.inner_cols, board.inner_rows, *found);
  if (!oriented) {
    view.why_not = "no " + Counts(board) + " board in the picture; " + oriented.error().what;
    return;
  }
  view.found = true;
  view.corners_px = std::move(*oriented);
}

AnnotatedView DetectIn(const GreyImage& image, const Checkerboard& board) {
  AnnotatedView result;
  result.view.target = board.id;
  result.view.image_width_px = image.width_px;
  result.view.image_height_px = image.height_px;
  FindBoard(image, board, result.view);
  result.picture = Annotated(image, result.view, board.inner_cols);
  return result;
}

AnnotatedView NotFound(const Checkerboard& board, std::string why_not) {
  AnnotatedView result;
  result.view.target = board.id;
  result.view.why_not = std::move(why_not);
  return result;
}

}  // namespace

std::string DetectorKey(const Checkerboard& board) {
  return "checkerboard-1/opencv-" CV_VERSION "/" + std::to_string(board.inner_cols) + "x" +
         std::to_string(board.inner_rows) + "/" + board.id.str();
}

AnnotatedView Detect(std::span<const std::byte> encoded, const Checkerboard& board) {
  if (std::string why_not = WhyUnsearchable(board); !why_not.empty()) return NotFound(board, std::move(why_not));
  const auto image = DecodeGrey(encoded);
  if (!image) return NotFound(board, image.error().what + "; " + image.error().cure);
  try {
    return DetectIn(*image, board);
  } catch (const std::exception& exception) {
    return NotFound(board, std::string("the search for the board failed: ") + exception.what());
  }
}

}  // namespace rigcal::detect

#include "server/detect/board.h"

#include <functional>
#include <locale>
#include <new>
#include <numeric>
#include <opencv2/core/version.hpp>
#include <sstream>

#include "server/base/process/out_of_memory.h"
#include "server/base/text.h"
#include "server/detect/checkerboard/corners.h"
#include "server/detect/checkerboard/orientation.h"
#include "server/detect/circles/circle_grid.h"
#include "server/detect/markers/charuco.h"
#include "server/detect/markers/markers.h"
#include "server/detect/markers/tag_grid.h"
#include "server/detect/pictures/annotate.h"
#include "server/detect/pictures/image_header.h"

namespace rigcal::detect {
namespace {

// Raised whenever the same picture could give other corners, or another reason why there are none: the code of the
// search, and what it wrongly said. (Its OpenCV is named beside it.)
constexpr int kCheckerboardVersion = 5, kMarkersVersion = 4, kCirclesVersion = 1;

constexpr int kInnerMin = 3, kInnerMax = 256;  // what the search supports, and a bound on its work

std::string Counts(const Target& board) { return std::to_string(board.cols) + " x " + std::to_string(board.rows); }

std::string WhyUnsearchableMarkers(const Target& board) {
  const int id_count = IdCount(board.dictionary);
  if (id_count == 0) return "the dictionary " + Quoted(board.dictionary) + " is not known";
  const int markers = MarkerCountOf(board);
  if (markers > id_count)
    return "a board of " + Counts(board) + " needs " + std::to_string(markers) + " markers, and " + board.dictionary +
           " has " + std::to_string(id_count);
  for (const int id : board.marker_ids)
    if (id >= id_count)
      return "marker id " + std::to_string(id) + " is not in " + board.dictionary + ", which has " +
             std::to_string(id_count);
  if (board.kind == TargetKind::kCharuco && (board.cols < 2 || board.rows < 2 || board.cols * board.rows < 6))
    return "a charuco board of " + Counts(board) + " inner corners is too small to tell a pose; it needs 2 x 3";
  return {};
}

std::string WhyUnsearchableCircles(const Target& board) {
  if (board.cols < 3 || board.rows < 3)
    return "a grid of " + Counts(board) + " circles is too small to tell where their centres are; it needs 3 x 3";
  if (!(board.diameter_m > 0 && board.square_m > 0)) return "the circles of the board have no size";
  return {};
}

// Empty: it can. Otherwise why not.
std::string WhyUnsearchable(const Target& board) {
  const bool checkerboard = board.kind == TargetKind::kCheckerboard;
  for (const int count : {board.cols, board.rows})
    if (count < (checkerboard ? kInnerMin : 1) || count > kInnerMax)
      return "a board of " + Counts(board) + " " + CountedOf(board.kind) + " cannot be searched; both counts must be " +
             (checkerboard ? "3" : "1") + " to 256";
  if (IsCircleGrid(board.kind)) return WhyUnsearchableCircles(board);
  return checkerboard ? std::string() : WhyUnsearchableMarkers(board);
}

void FindCheckerboard(const GreyImage& image, const Target& board, BoardView& view) {
  const auto found = FindCorners(image, board.cols, board.rows);
  if (!found) {
    view.why_not = "no " + Counts(board) + " board in the picture; show the whole board, sharp and evenly lit";
    return;
  }
  auto oriented = Oriented(image, board.cols, board.rows, *found);
  if (!oriented) {
    view.why_not = "no " + Counts(board) + " board in the picture; " + oriented.error().what;
    return;
  }
  view.found = true;
  view.corners_px = std::move(*oriented);
  view.corner_idx.resize(view.corners_px.size());
  std::iota(view.corner_idx.begin(), view.corner_idx.end(), 0);
}

void FindBoard(const GreyImage& image, const Target& board, BoardView& view) {
  switch (board.kind) {
    case TargetKind::kCheckerboard:
      return FindCheckerboard(image, board, view);
    case TargetKind::kCharuco:
      return FindCharuco(image, board, view);
    case TargetKind::kArucoGrid:
    case TargetKind::kAprilGrid:
      return FindTagGrid(image, board, view);
    case TargetKind::kCircleGrid:
    case TargetKind::kAsymmetricCircleGrid:
      return FindCircleGrid(image, board, view);
  }
}

BoardView Searched(const GreyImage& image, const Target& board) {
  BoardView view;
  view.target = board.id;
  view.image_width_px = image.width_px;
  view.image_height_px = image.height_px;
  FindBoard(image, board, view);
  return view;
}

AnnotatedView NotFound(const Target& board, std::string why_not, const ImageSize& size) {
  AnnotatedView result;
  result.view.target = board.id;
  result.view.image_width_px = static_cast<int>(size.width_px);
  result.view.image_height_px = static_cast<int>(size.height_px);
  result.view.why_not = std::move(why_not);
  return result;
}

// What a library throws is a search that found nothing out.
AnnotatedView Guarded(const Target& board, const std::function<AnnotatedView()>& search) {
  try {
    return search();
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw std::bad_alloc();
    return NotFound(board, std::string("the search for the board failed: ") + exception.what(), {});
  }
}

}  // namespace

std::string DetectorKey(const Target& target) {
  const int version = target.kind == TargetKind::kCheckerboard ? kCheckerboardVersion
                      : IsCircleGrid(target.kind)              ? kCirclesVersion
                                                               : kMarkersVersion;
  const std::string search = "-" + std::to_string(version) + "/opencv-" CV_VERSION "/";
  const std::string geometry = std::to_string(target.cols) + "x" + std::to_string(target.rows) + "/";
  if (target.kind == TargetKind::kCheckerboard) return "checkerboard" + search + geometry + target.id.str();
  std::ostringstream markers;  // only ratios show in the picture, of the board beside its counts
  markers.imbue(std::locale::classic());
  markers.precision(9);
  if (!IsCircleGrid(target.kind)) markers << target.dictionary << "/";
  if (IsCircleGrid(target.kind))
    markers << target.diameter_m / target.square_m << "/";
  else if (target.kind == TargetKind::kCharuco)
    markers << target.marker_m / target.square_m << (target.legacy_layout ? "/legacy/" : "/");
  else
    markers << target.spacing_ratio << "/";
  for (const int id : target.marker_ids) markers << id << (id == target.marker_ids.back() ? "/" : ",");
  return NameOf(target.kind) + search + geometry + markers.str() + target.id.str();
}

BoardView FindIn(const GreyImage& image, const Target& board) {
  if (std::string why_not = WhyUnsearchable(board); !why_not.empty())
    return NotFound(board, std::move(why_not), {image.width_px, image.height_px}).view;
  return Guarded(board, [&] { return AnnotatedView{Searched(image, board), {}}; }).view;
}

AnnotatedView Detect(std::span<const std::byte> encoded, const Target& board) {
  if (std::string why_not = WhyUnsearchable(board); !why_not.empty())
    return NotFound(board, std::move(why_not), ReadImageSize(encoded).value_or(ImageSize{}));
  const auto image = DecodeGrey(encoded);
  if (!image) return NotFound(board, image.error().what + "; " + image.error().cure, {});
  return Guarded(board, [&] {
    BoardView view = Searched(*image, board);
    std::string picture = Annotated(*image, view, board);
    return AnnotatedView{std::move(view), std::move(picture)};
  });
}

}  // namespace rigcal::detect

#include "server/detect/checkerboard/corner_refine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "server/detect/pictures/plane_map.h"

namespace rigcal::detect {
namespace {

constexpr double kSmoothMax_px = 1.0, kSmoothPerWindow = 0.25;  // of what the window has more than 2 px
constexpr int kSmoothReach_px = 6;
constexpr double kReach = 2.5;      // in pitches: whose word counts
constexpr std::size_t kAsked = 12;  // nearest corners that are asked at most
constexpr double kTolerance = 1.0 / 12, kToleranceMin_px = 1.0;

using Neighbours = std::vector<std::vector<std::size_t>>;

Neighbours NearestOf(const std::vector<BoardCorner>& corners, double pitch_m) {
  Neighbours neighbours(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j < corners.size(); ++j) {
      const double distance_m = (corners[i].board_m - corners[j].board_m).norm();
      if (j != i && distance_m < kReach * pitch_m) near.emplace_back(distance_m, j);
    }
    std::sort(near.begin(), near.end());
    for (const auto& [distance_m, j] : near) neighbours[i].push_back(j);
  }
  return neighbours;
}

// Pixels by which corner i is off, over the tolerance there; 0 where its neighbours cannot tell.
double Excess(const std::vector<BoardCorner>& corners, const std::vector<bool>& kept,
              const std::vector<std::size_t>& neighbours, std::size_t i, double pitch_m) {
  std::vector<Eigen::Vector2d> board, pixels;
  for (const std::size_t j : neighbours) {
    if (!kept[j] || board.size() == kAsked) continue;
    board.push_back(corners[j].board_m);
    pixels.push_back(corners[j].corner_px);
  }
  const auto map = PlaneMap::Fit(board, pixels);
  if (!map || board.size() < 5) return 0;
  const auto told = map->Pixel(corners[i].board_m);
  const double pitch_px =
      (pixels.front() - corners[i].corner_px).norm() / (board.front() - corners[i].board_m).norm() * pitch_m;
  if (!told) return 0;
  return (*told - corners[i].corner_px).norm() / std::max(kToleranceMin_px, kTolerance * pitch_px);
}

// Marks what is worst among its neighbours and beyond the tolerance. True if there was any.
bool DropWorst(const std::vector<BoardCorner>& corners, const Neighbours& neighbours, double pitch_m,
               std::vector<bool>& kept) {
  std::vector<double> excess(corners.size(), 0);
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (kept[i]) excess[i] = Excess(corners, kept, neighbours[i], i, pitch_m);
  bool dropped = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const bool worst =
        std::none_of(neighbours[i].begin(), neighbours[i].end(), [&](std::size_t j) { return excess[j] > excess[i]; });
    if (!(excess[i] > 1) || !worst) continue;
    kept[i] = false;
    dropped = true;
  }
  return dropped;
}

// Corners on the line through two of them, these included.
std::size_t OnLine(const std::vector<BoardCorner>& corners, std::size_t a, std::size_t b) {
  const Eigen::Vector2d along = corners[b].board_m - corners[a].board_m;
  std::size_t count = 0;
  for (const BoardCorner& corner : corners) {
    const Eigen::Vector2d from = corner.board_m - corners[a].board_m;
    if (std::abs(along.x() * from.y() - along.y() * from.x()) <= 1e-6 * along.norm() * (from.norm() + along.norm()))
      ++count;
  }
  return count;
}

}  // namespace

Eigen::Vector2d EdgesMeet(const GreyImage& image, const Eigen::Vector2d& start_px, int window_px) {
  const cv::Mat grey(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  if (!(start_px.minCoeff() >= 0 && start_px.x() <= image.width_px - 1 && start_px.y() <= image.height_px - 1))
    return start_px;
  const int half_px = 2 * window_px + kSmoothReach_px;  // the window moves by its own half at most
  const cv::Rect around(static_cast<int>(start_px.x()) - half_px, static_cast<int>(start_px.y()) - half_px,
                        2 * half_px + 1, 2 * half_px + 1);
  const cv::Rect part = around & cv::Rect(0, 0, grey.cols, grey.rows);
  if (part.width < 2 * window_px + 5 || part.height < 2 * window_px + 5) return start_px;  // too close to the border
  cv::Mat smooth;
  grey(part).convertTo(smooth, CV_32F);
  // Small squares have no room for it: the next edges would come in.
  const double smooth_px = std::min(kSmoothMax_px, kSmoothPerWindow * (window_px - 2));
  if (smooth_px > 0) cv::GaussianBlur(smooth, smooth, {}, smooth_px);
  const Eigen::Vector2d origin_px(part.x, part.y), start_in_part = start_px - origin_px;
  const cv::Point2f start(static_cast<float>(start_in_part.x()), static_cast<float>(start_in_part.y()));
  std::vector<cv::Point2f> corner = {start};
  cv::cornerSubPix(smooth, corner, {window_px, window_px}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 100, 1e-4});
  // OpenCV puts a corner that left its window back to the start.
  return corner.front() == start ? start_px
                                 : Eigen::Vector2d(origin_px.x() + corner.front().x, origin_px.y() + corner.front().y);
}

std::optional<Eigen::Vector2d> Refined(const GreyImage& image, const Eigen::Vector2d& start_px, int window_px,
                                       double move_max_px) {
  const double margin_px = window_px + 1;
  if (!(start_px.x() >= margin_px && start_px.y() >= margin_px && start_px.x() <= image.width_px - 1 - margin_px &&
        start_px.y() <= image.height_px - 1 - margin_px))
    return std::nullopt;
  const Eigen::Vector2d refined_px = EdgesMeet(image, start_px, window_px);
  if (refined_px == start_px) return std::nullopt;
  if (!refined_px.allFinite() || (refined_px - start_px).norm() > move_max_px) return std::nullopt;
  return refined_px;
}

std::vector<BoardCorner> Consistent(std::vector<BoardCorner> corners, double pitch_m) {
  const Neighbours neighbours = NearestOf(corners, pitch_m);
  std::vector<bool> kept(corners.size(), true);
  while (DropWorst(corners, neighbours, pitch_m, kept)) continue;
  std::vector<BoardCorner> consistent;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (kept[i]) consistent.push_back(corners[i]);
  return consistent;
}

bool SpreadEnough(const std::vector<BoardCorner>& corners, std::size_t count_min) {
  const std::size_t count = corners.size();
  if (count < std::max<std::size_t>(4, count_min)) return false;
  // A line with all but one of them holds two of any three.
  for (const auto& [a, b] : {std::pair{0u, 1u}, std::pair{0u, 2u}, std::pair{1u, 2u}})
    if (OnLine(corners, a, b) + 1 >= count) return false;
  return true;
}

void Show(const std::vector<BoardCorner>& corners, BoardView& view) {
  view.found = true;
  for (const BoardCorner& corner : corners) {
    view.corner_idx.push_back(corner.idx);
    view.corners_px.push_back(corner.corner_px);
  }
}

}  // namespace rigcal::detect

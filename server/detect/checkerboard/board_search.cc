#include "server/detect/checkerboard/board_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/detect/checkerboard/saddle_grid.h"

namespace rigcal::detect {
namespace {

constexpr int kSideMin_px = 72;        // of a level worth searching
constexpr int kEnlargeSide_px = 1400;  // pictures up to this size are also searched enlarged
// Squares reach from 7 pixels to this on a level, so that each is within reach on several.
constexpr float kReach_px = 56, kReachFull_px = 32;
// From this size on no row is lost on a level; smaller squares may be a part of a pattern that finer levels show whole.
constexpr float kSureSquare_px = 9;
constexpr std::size_t kGridsMax = 12;
constexpr std::size_t kPartMin = 4;
constexpr double kPartRatio = 0.15;  // of the corners, that make a grid worth growing
// Of the corners, and of the places among those seen: what makes it likely that all are there. Mosaics have gaps.
// A few corners are a part of anything.
constexpr double kHopeRatio = 0.4, kHopeFilledRatio = 0.65;
constexpr std::size_t kHopeMin = 14;

struct Counts {
  int cols = 0, rows = 0;
  [[nodiscard]] std::size_t All() const { return static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows); }
};

using Corners = std::vector<Eigen::Vector2f>;

// In the level's pixels. Empty unless the grid has exactly these counts.
Corners CornersOf(const SaddleGrid& grid, const GridBox& box, const Counts& counts) {
  const bool upright = box.Cols() == counts.cols && box.Rows() == counts.rows;
  if (!upright && !(box.Cols() == counts.rows && box.Rows() == counts.cols)) return {};
  Corners corners;
  for (int row = 0; row < counts.rows; ++row)
    for (int col = 0; col < counts.cols; ++col) {
      const auto node = grid.find({box.col_min + (upright ? col : row), box.row_min + (upright ? row : col)});
      if (node == grid.end()) return {};
      corners.push_back(node->second.saddle.at_px);
    }
  return corners;
}

// Part of the places in the box that have a corner.
double FilledRatio(const SaddleGrid& grid, const GridBox& box) {
  const auto filled = std::count_if(grid.begin(), grid.end(), [&](const auto& node) { return box.Has(node.first); });
  return static_cast<double>(filled) / std::max(1, box.Cols() * box.Rows());
}

// Larger than the board, or whole, and of other counts.
bool IsOther(const SaddleGrid& grid, const GridBox& box, const Counts& counts) {
  constexpr int kSideMin = 3;
  if (FilledRatio(grid, box) == 1.0 && std::min(box.Cols(), box.Rows()) >= kSideMin) return true;
  return std::max(box.Cols(), box.Rows()) > std::max(counts.cols, counts.rows) ||
         std::min(box.Cols(), box.Rows()) > std::min(counts.cols, counts.rows);
}

GridPart PartOf(const GreyLevel& level, const SaddleGrid& grid) {
  GridPart part{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, 0, grid.size()};
  double sum_px = 0;
  int steps = 0;
  for (const auto& [place, node] : grid) {
    const Eigen::Vector2d at_px = level.InPicture(node.saddle.at_px);
    part.min_px = part.min_px.cwiseMin(at_px), part.max_px = part.max_px.cwiseMax(at_px);
    for (const GridPlace& next : {GridPlace{place.first + 1, place.second}, GridPlace{place.first, place.second + 1}})
      if (const auto found = grid.find(next); found != grid.end())
        sum_px += (level.InPicture(found->second.saddle.at_px) - at_px).norm(), ++steps;
  }
  part.square_px = sum_px / std::max(1, steps);
  return part;
}

// From a level to the next finer one, twice as large.
void Follow(const GreyLevel& finer, Corners& corners) {
  constexpr float kOff_px = 2.5;
  for (Eigen::Vector2f& corner : corners) {
    corner = (corner.array() * 2 + 0.5f).matrix();
    if (const auto saddle = SaddleNear(finer, corner, kOff_px)) corner = saddle->at_px;
  }
}

// What was seen where the board was not found.
struct Seen {
  std::vector<GridPart> parts, others;
};

// In the level's pixels; empty: not found.
Corners SearchLevel(const GreyLevel& level, float reach_px, const Counts& counts, Seen& seen) {
  const std::vector<Saddle> saddles = SaddlePoints(level);
  const auto part_min = std::max(kPartMin, static_cast<std::size_t>(kPartRatio * static_cast<double>(counts.All())));
  std::vector<SaddleGrid> grids = GridsOf(saddles, NeighboursOf(level, saddles, reach_px), part_min);
  if (grids.size() > kGridsMax) grids.resize(kGridsMax);
  for (SaddleGrid& grid : grids) {
    Grow(level, 2 * counts.All() + 64, grid);
    if (grid.size() < part_min) continue;
    const GridBox box = BoxOf(level, grid);
    Corners corners = CornersOf(grid, box, counts);
    if (!corners.empty()) return corners;
    if (IsOther(grid, box, counts))
      seen.others.push_back(PartOf(level, grid));
    else if (grid.size() >= kHopeMin &&
             static_cast<double>(grid.size()) > kHopeRatio * static_cast<double>(counts.All()) &&
             FilledRatio(grid, box) > kHopeFilledRatio)
      seen.parts.push_back(PartOf(level, grid));
  }
  return {};
}

std::vector<GridPart> PartsOf(const Seen& seen) {
  std::vector<GridPart> parts;
  for (const GridPart& part : seen.parts)
    if (std::none_of(seen.others.begin(), seen.others.end(),
                     [&](const GridPart& other) { return IsPartOf(part, other); }))
      parts.push_back(part);
  std::stable_sort(parts.begin(), parts.end(),
                   [](const GridPart& a, const GridPart& b) { return a.corners > b.corners; });
  return parts;
}

std::vector<GreyLevel> LevelsOf(const GreyImage& image) {
  std::vector<GreyLevel> levels;
  if (std::max(image.width_px, image.height_px) <= kEnlargeSide_px) levels.push_back(Doubled(image));
  levels.push_back(LevelOf(image));
  while (std::min(levels.back().width_px, levels.back().height_px) >= 2 * kSideMin_px)
    levels.push_back(Halved(levels.back()));
  return levels;
}

// From the level where they were found to the picture.
std::vector<Eigen::Vector2d> Followed(const std::vector<GreyLevel>& levels, std::size_t at, Corners corners) {
  while (levels[at].scale < 1) Follow(levels[--at], corners);
  std::vector<Eigen::Vector2d> corners_px;
  for (const Eigen::Vector2f& corner : corners) corners_px.push_back(levels[at].InPicture(corner));
  return corners_px;
}

float ShortestStep_px(const Corners& corners, const Counts& counts) {
  float shortest = HUGE_VALF;
  const auto cols = static_cast<std::size_t>(counts.cols);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if ((i + 1) % cols != 0) shortest = std::min(shortest, (corners[i + 1] - corners[i]).norm());
    if (i + cols < corners.size()) shortest = std::min(shortest, (corners[i + cols] - corners[i]).norm());
  }
  return shortest;
}

bool InAnother(const std::vector<Eigen::Vector2d>& corners_px, const std::vector<GridPart>& others) {
  GridPart grid{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, 0, corners_px.size()};
  for (const Eigen::Vector2d& corner : corners_px)
    grid.min_px = grid.min_px.cwiseMin(corner), grid.max_px = grid.max_px.cwiseMax(corner);
  grid.square_px = (corners_px[1] - corners_px[0]).norm();
  return std::any_of(others.begin(), others.end(), [&](const GridPart& other) { return IsPartOf(grid, other); });
}

}  // namespace

BoardSearch SearchBoard(const GreyImage& image, int cols, int rows) {
  const Counts counts{cols, rows};
  const std::vector<GreyLevel> levels = LevelsOf(image);
  BoardSearch search;
  Seen seen;
  std::vector<Eigen::Vector2d> unsure_px;
  // From coarse to fine: coarse levels cost little, and clutter and noise are gone there.
  for (std::size_t i = levels.size(); i-- > 0;) {
    const bool finest = i == 0 && levels.size() > 1;
    const Corners corners = SearchLevel(levels[i], finest ? kReachFull_px : kReach_px, counts, seen);
    if (corners.empty()) continue;
    auto followed_px = Followed(levels, i, corners);
    if (i == 0 || ShortestStep_px(corners, counts) >= kSureSquare_px) {
      search.corners_px = std::move(followed_px);
      return search;
    }
    unsure_px = std::move(followed_px);
  }
  search.parts = PartsOf(seen);
  search.others = std::move(seen.others);
  if (!unsure_px.empty() && !InAnother(unsure_px, search.others)) search.corners_px = std::move(unsure_px);
  return search;
}

bool IsPartOf(const GridPart& part, const GridPart& other) {
  constexpr double kSquareRatio = 0.6;
  const Eigen::Array2d middle = (part.min_px + part.max_px) / 2;
  return (middle > other.min_px.array()).all() && (middle < other.max_px.array()).all() &&
         other.square_px > kSquareRatio * part.square_px && other.corners >= part.corners;
}

}  // namespace rigcal::detect

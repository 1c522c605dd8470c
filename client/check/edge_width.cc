#include "client/check/edge_width.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace rigcal::check {
namespace {

constexpr double kStep_px = 0.25;                          // between samples of a profile
constexpr double kReachMin_px = 3.0, kReachMax_px = 20.0;  // to either side of the edge
constexpr double kContrastMin_grey = 20.0;
constexpr std::size_t kEdgesMin = 4, kEdgesOfTag = 2;  // along columns, and along rows
constexpr double kBlurred_px = 6.0, kBlurred_ratio = 1.0 / 400, kUsualFactor = 2.0, kAlwaysSharp_px = 4.0;

// Two neighbouring points of a target with an edge between them.
struct BoardSide {
  int from = 0, to = 0;
  bool along_columns = false;  // the x of the board
};

std::vector<BoardSide> SidesOfTags(const Target& board) {
  std::vector<BoardSide> sides;
  for (int tag = 0; tag < board.cols * board.rows; ++tag)
    for (int i = 0; i < 4; ++i) sides.push_back({4 * tag + i, 4 * tag + (i + 1) % 4, i % 2 == 0});
  return sides;
}

std::vector<BoardSide> SidesOf(const Target& board) {
  if (IsTagGrid(board.kind)) return SidesOfTags(board);
  std::vector<BoardSide> sides;
  for (int row = 0; row < board.rows; ++row)
    for (int col = 0; col < board.cols; ++col) {
      const int idx = row * board.cols + col;
      if (col + 1 < board.cols) sides.push_back({idx, idx + 1, true});
      if (row + 1 < board.rows) sides.push_back({idx, idx + board.cols, false});
    }
  return sides;
}

// How far a profile may reach before it meets the next edge, over the length of a side.
double ReachRatio(const Target& board) {
  if (IsTagGrid(board.kind)) return std::min(0.09, 0.9 * board.spacing_ratio);  // a border is a tenth of a tag, or more
  if (IsCircleGrid(board.kind)) {
    const double steps = board.kind == TargetKind::kAsymmetricCircleGrid ? 2 : 1;
    return std::min(0.9, 0.9 * (2 * steps * board.square_m / board.diameter_m - 2));
  }
  if (board.kind == TargetKind::kCharuco) return 0.45 * (1.0 - board.marker_m / board.square_m);
  return 0.4;
}

// In the picture.
struct BoardEdge {
  Eigen::Vector2d from_px, to_px;
  bool along_columns = false;
  [[nodiscard]] double Length_px() const { return (to_px - from_px).norm(); }
};

using PointPlaces = std::map<int, Eigen::Vector2d>;  // by index

// Of a circle on the way to its neighbours in its row and below, as long as its radius: over the middle of that it is
// straight enough.
std::vector<BoardEdge> EdgesOfCircles(const PointPlaces& places, const Target& board) {
  const int steps = board.kind == TargetKind::kAsymmetricCircleGrid ? 2 : 1;  // rows to the next one right below
  const double radius_ratio = board.diameter_m / 2 / (steps * board.square_m);
  std::vector<BoardEdge> edges;
  for (const auto& [idx, centre_px] : places) {
    const auto right = places.find(idx + 1), below = places.find(idx + steps * board.cols);
    if ((idx + 1) % board.cols == 0 || right == places.end() || below == places.end()) continue;
    const Eigen::Vector2d x_px = radius_ratio * (right->second - centre_px);
    const Eigen::Vector2d y_px = radius_ratio * (below->second - centre_px);
    edges.push_back({centre_px + x_px - y_px / 2, centre_px + x_px + y_px / 2, false});
    edges.push_back({centre_px + y_px - x_px / 2, centre_px + y_px + x_px / 2, true});
  }
  return edges;
}

std::vector<BoardEdge> EdgesOf(const BoardView& view, const Target& board) {
  PointPlaces places;
  for (std::size_t i = 0; i < view.corner_idx.size(); ++i) places[view.corner_idx[i]] = view.corners_px[i];
  if (IsCircleGrid(board.kind)) return EdgesOfCircles(places, board);
  std::vector<BoardEdge> edges;
  for (const BoardSide& side : SidesOf(board)) {
    const auto from = places.find(side.from), to = places.find(side.to);
    if (from != places.end() && to != places.end()) edges.push_back({from->second, to->second, side.along_columns});
  }
  return edges;
}

double MiddleOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::size_t EdgesMin(const Target& board) {
  return IsTagGrid(board.kind) && MarkerCountOf(board) == 1 ? kEdgesOfTag : kEdgesMin;
}

// Of the edges along columns or along rows; 0 where they are fewer than `count_min`.
template <typename Of>
double MedianAlong(const std::vector<BoardEdge>& edges, bool along_columns, std::size_t count_min, const Of& of) {
  std::vector<double> values;
  for (const BoardEdge& edge : edges)
    if (edge.along_columns == along_columns)
      if (const std::optional<double> value = of(edge)) values.push_back(*value);
  return values.size() < count_min ? 0.0 : MiddleOf(std::move(values));
}

// Grey across the edge, every kStep_px, the mean of places along its middle part.
std::vector<double> ProfileAcross(const detect::GreyImage& image, const BoardEdge& edge, double reach_px) {
  const Eigen::Vector2d along = edge.to_px - edge.from_px;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const int half = static_cast<int>(std::floor(reach_px / kStep_px));
  std::vector<double> profile;
  for (int k = -half; k <= half; ++k) {
    double sum = 0;
    for (const double part : {0.3, 0.4, 0.5, 0.6, 0.7}) {
      const Eigen::Vector2d place = edge.from_px + part * along + k * kStep_px * across;
      sum += image.Between(place.x(), place.y());
    }
    profile.push_back(sum / 5);
  }
  return profile;
}

// Of a profile that rises from `low` to `high`, from its middle outwards.
double RiseOf(const std::vector<double>& profile, double low, double high) {
  const auto part = [&](std::size_t k) { return (profile[k] - low) / (high - low); };
  const std::size_t last = profile.size() - 1;
  std::size_t middle = last / 2;
  while (middle < last && part(middle) < 0.5) ++middle;
  while (middle > 0 && part(middle) > 0.5) --middle;
  std::size_t left = middle, right = middle;
  while (left > 0 && part(left) > 0.1) --left;
  while (right < last && part(right) < 0.9) ++right;
  const auto between = [&](std::size_t below, std::size_t above, double at) {
    const double rise = part(above) - part(below);
    return rise > 0 ? std::clamp((at - part(below)) / rise, 0.0, 1.0) : 0.0;
  };
  const double begins = static_cast<double>(left) + (left < last ? between(left, left + 1, 0.1) : 0.0);
  const double ends = static_cast<double>(right) - (right > 0 ? 1 - between(right - 1, right, 0.9) : 0.0);
  return std::max(0.0, ends - begins) * kStep_px;
}

// Nothing where dark and light differ by too little.
std::optional<double> WidthOf(const detect::GreyImage& image, const BoardEdge& edge, double reach_px) {
  std::vector<double> profile = ProfileAcross(image, edge, reach_px);
  const auto outer = static_cast<std::ptrdiff_t>(std::max<std::size_t>(2, profile.size() / 8));
  const auto mean = [&](auto begin) {
    double sum = 0;
    for (auto it = begin; it != begin + outer; ++it) sum += *it;
    return sum / static_cast<double>(outer);
  };
  if (mean(profile.begin()) > mean(profile.rbegin())) std::reverse(profile.begin(), profile.end());
  const double low = mean(profile.begin()), high = mean(profile.rbegin());
  if (high - low < kContrastMin_grey) return std::nullopt;
  return RiseOf(profile, low, high);
}

}  // namespace

std::optional<double> EdgeWidth_px(const detect::GreyImage& image, const BoardView& view, const Target& board) {
  const std::vector<BoardEdge> edges = EdgesOf(view, board);
  const std::size_t count_min = EdgesMin(board);
  const auto length = [](const BoardEdge& edge) { return std::optional(edge.Length_px()); };
  const double shorter_px =
      std::min(MedianAlong(edges, true, count_min, length), MedianAlong(edges, false, count_min, length));
  const double reach_px = std::min(kReachMax_px, ReachRatio(board) * shorter_px);
  if (!(reach_px >= kReachMin_px)) return std::nullopt;
  const auto width = [&](const BoardEdge& edge) { return WidthOf(image, edge, reach_px); };
  const double wider_px =
      std::max(MedianAlong(edges, true, count_min, width), MedianAlong(edges, false, count_min, width));
  return wider_px > 0 ? std::optional(wider_px) : std::nullopt;
}

double BlurredFrom_px(int image_width_px, double usual_px) {
  return std::min(std::max(kBlurred_px, kBlurred_ratio * image_width_px),
                  std::max(kAlwaysSharp_px, kUsualFactor * usual_px));
}

}  // namespace rigcal::check

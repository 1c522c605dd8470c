#include "server/detect/markers/charuco.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "server/detect/checkerboard/corner_refine.h"
#include "server/detect/markers/marker_layout.h"
#include "server/detect/pictures/plane_map.h"
#include "server/model/sensors/board_layout.h"

namespace rigcal::detect {
namespace {

constexpr std::size_t kCornersMin = 6;
// The refinement's window reaches from the corner to the markers' borders, which lie around it symmetrically.
constexpr double kWindowRatio = 1.0;
constexpr int kWindowMin_px = 2, kWindowMax_px = 12;
constexpr double kMoveMaxRatio = 0.1, kMoveMin_px = 1.5;  // of the square
constexpr double kRingRatio = 0.9, kAsymmetryMax = 0.25;  // radius in margins around markers; part of the contrast
constexpr int kRingPairs = 12;
constexpr double kContrastMin = 6;  // grey levels between dark and light squares at a corner

struct Sight {
  std::vector<PlacedMarker> markers;
  std::size_t seen = 0;
  int strangers = 0;
  bool other_layout = false;  // the other layout explains more of the markers
};

Sight SightOf(const GreyImage& image, const Target& target, bool from_behind) {
  const MarkerLayout layout = CharucoLayout(target, target.legacy_layout);
  const MarkerLayout other = CharucoLayout(target, !target.legacy_layout);
  MarkerSearch search{target.dictionary, MarkerIdsOf(target)};
  search.from_behind = from_behind;
  std::vector<SeenMarker> seen;
  Sight sight;
  for (const double scale : MarkerScales(image)) {
    search.scale = scale;
    const FoundMarkers found = FindMarkers(image, search);
    Join(seen, found.markers);
    sight.strangers = std::max(sight.strangers, found.strangers);
    sight.markers = Placed(layout, seen, 0);
    if (sight.markers.size() == layout.quads.size()) break;
  }
  sight.seen = seen.size();
  sight.other_layout = Placed(other, seen, 0).size() > sight.markers.size();
  return sight;
}

bool IsBoard(const Sight& sight) { return !sight.other_layout && Credible(sight.markers.size(), sight.seen); }

// What is known of an inner corner before its refinement.
struct Candidate {
  BoardCorner corner;
  PlaneMap map;          // around it
  double square_px = 0;  // the smallest distance to where the next corners are
};

std::optional<Candidate> CandidateAt(const Target& target, const std::map<int, PlacedMarker>& around, int col,
                                     int row) {
  std::vector<Eigen::Vector2d> board, pixels;
  for (const auto& [id, marker] : around) {
    board.insert(board.end(), marker.board_m.begin(), marker.board_m.end());
    pixels.insert(pixels.end(), marker.corners_px.begin(), marker.corners_px.end());
  }
  const auto map = PlaneMap::Fit(board, pixels);
  if (!map) return std::nullopt;
  const Eigen::Vector2d place_m = Eigen::Vector2d(col, row) * target.square_m;
  const auto pixel = map->Pixel(place_m);
  if (!pixel) return std::nullopt;
  Candidate candidate{{row * target.cols + col, place_m, *pixel}, *map, HUGE_VAL};
  for (const auto& step :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)})
    if (const auto next = map->Pixel(place_m + step * target.square_m))
      candidate.square_px = std::min(candidate.square_px, (*next - *pixel).norm());
  if (!std::isfinite(candidate.square_px)) return std::nullopt;
  return candidate;
}

// Corners that touch the square of a marker.
std::vector<Candidate> Candidates(const Target& target, const std::vector<PlacedMarker>& markers) {
  std::map<int, std::map<int, PlacedMarker>> around;  // corner: marker id
  for (const PlacedMarker& marker : markers) {
    const Eigen::Vector2d centre = (marker.board_m[0] + marker.board_m[2]) / (2 * target.square_m);
    const int col = static_cast<int>(std::floor(centre.x())), row = static_cast<int>(std::floor(centre.y()));
    for (const auto& [c, r] : {std::pair{col, row}, {col + 1, row}, {col, row + 1}, {col + 1, row + 1}})
      if (c >= 0 && r >= 0 && c < target.cols && r < target.rows) around[r * target.cols + c][marker.place] = marker;
  }
  std::vector<Candidate> candidates;
  for (const auto& [idx, near] : around)
    if (auto candidate = CandidateAt(target, near, idx % target.cols, idx / target.cols))
      candidates.push_back(*std::move(candidate));
  return candidates;
}

// Mean difference between opposite places around the corner: small where nothing else reaches into the picture of it.
double Asymmetry(const GreyImage& image, const Target& target, const Candidate& candidate,
                 const Eigen::Vector2d& refined_px) {
  const double radius_m = kRingRatio * (target.square_m - target.marker_m) / 2;
  double sum = 0;
  for (int i = 0; i < kRingPairs; ++i) {
    const double angle = M_PI * (i + 0.5) / kRingPairs;
    const Eigen::Vector2d step_m = radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const auto there = candidate.map.Pixel(candidate.corner.board_m + step_m);
    const auto opposite = candidate.map.Pixel(candidate.corner.board_m - step_m);
    if (!there || !opposite) return HUGE_VAL;
    const Eigen::Vector2d step_px = (*there - *opposite) / 2;
    const Eigen::Vector2d a = refined_px + step_px, b = refined_px - step_px;
    sum += std::abs(image.Between(a.x(), a.y()) - image.Between(b.x(), b.y()));
  }
  return sum / kRingPairs;
}

// Whether the two squares with markers are lighter (+1) or darker (-1) than the two others, sampled in the margin
// around the markers; 0: neither, so that this is no corner of four
// squares, or something reaches into it.
int Polarity(const GreyImage& image, const Target& target, const Candidate& candidate,
             const Eigen::Vector2d& refined_px) {
  const double reach_m = 0.7 * (target.square_m - target.marker_m) / 2;
  const int col = candidate.corner.idx % target.cols, row = candidate.corner.idx / target.cols;
  std::vector<double> with, without;
  for (const auto& [right, down] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
    const Eigen::Vector2d step((right ? 1 : -1) * reach_m, (down ? 1 : -1) * reach_m);
    const auto at_px = candidate.map.Pixel(candidate.corner.board_m + step);
    if (!at_px) return 0;
    const bool marker = HasMarker(target, target.legacy_layout, col + right, row + down);
    (marker ? with : without).push_back(image.Between(at_px->x(), at_px->y()));
  }
  const double contrast = std::abs(with[0] + with[1] - without[0] - without[1]) / 2;
  if (Asymmetry(image, target, candidate, refined_px) > kAsymmetryMax * contrast) return 0;
  if (std::min(with[0], with[1]) > std::max(without[0], without[1]) + kContrastMin) return 1;
  return std::max(with[0], with[1]) < std::min(without[0], without[1]) - kContrastMin ? -1 : 0;
}

std::vector<BoardCorner> Corners(const GreyImage& image, const Target& target,
                                 const std::vector<Candidate>& candidates) {
  const double margin_ratio = (1 - target.marker_m / target.square_m) / 2;
  std::vector<BoardCorner> corners;
  std::vector<int> polarities;
  int balance = 0;
  for (const Candidate& candidate : candidates) {
    const int window_px = std::clamp(static_cast<int>(std::lround(kWindowRatio * margin_ratio * candidate.square_px)),
                                     kWindowMin_px, kWindowMax_px);
    const double move_max_px = std::max(kMoveMin_px, kMoveMaxRatio * candidate.square_px);
    const auto refined = Refined(image, candidate.corner.corner_px, window_px, move_max_px);
    const int polarity = refined ? Polarity(image, target, candidate, *refined) : 0;
    if (polarity == 0) continue;
    corners.push_back({candidate.corner.idx, candidate.corner.board_m, *refined});
    polarities.push_back(polarity);
    balance += polarity;
  }
  std::vector<BoardCorner> alike;  // of the colours that most have: a board is dark on light or light on dark
  for (std::size_t i = 0; i < corners.size(); ++i)
    if ((polarities[i] > 0) == (balance > 0)) alike.push_back(corners[i]);
  return Consistent(alike, target.square_m);
}

std::string Squares(const Target& target) {
  return std::to_string(target.cols + 1) + " x " + std::to_string(target.rows + 1) + " squares";
}

std::string WhyNot(const Target& target, const Sight& sight, std::size_t corners) {
  const std::string board = "no charuco board of " + Squares(target) + " in the picture";
  if (sight.other_layout)
    return board + "; it looks like the " +
           (target.legacy_layout ? "layout of OpenCV 4.6 and later: " : "legacy layout: ") + std::string(kSetsLayout) +
           (target.legacy_layout ? "false" : "true");
  if (sight.seen == 0 && sight.strangers > 0)
    return board + "; the " + std::to_string(sight.strangers) + " markers in it have ids that this board does not have";
  if (sight.seen == 0)
    return board + "; no marker of " + target.dictionary + " was read: show the board sharp and evenly lit";
  if (!Credible(sight.markers.size(), sight.seen))
    return board + "; the markers read (" + std::to_string(sight.seen) +
           ") are not placed as on it: check squares and dictionary";
  return board + "; " + std::to_string(corners) + " of its corners can be seen, and at least " +
         std::to_string(kCornersMin) + " not on a line are needed";
}

}  // namespace

void FindCharuco(const GreyImage& image, const Target& target, BoardView& view) {
  if (!AnyMarkers(image, {target.dictionary, MarkerIdsOf(target)}, std::array{1})) {
    view.why_not = WhyNot(target, {}, 0);
    return;
  }
  Sight sight = SightOf(image, target, false);
  if (!IsBoard(sight) && !sight.other_layout)
    if (Sight behind = SightOf(image, target, true); IsBoard(behind)) sight = std::move(behind);
  std::vector<BoardCorner> corners;
  if (IsBoard(sight)) corners = Corners(image, target, Candidates(target, sight.markers));
  if (!SpreadEnough(corners, kCornersMin)) {
    view.why_not = WhyNot(target, sight, corners.size());
    return;
  }
  Show(corners, view);
}

}  // namespace rigcal::detect

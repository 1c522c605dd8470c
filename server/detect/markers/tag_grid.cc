#include "server/detect/markers/tag_grid.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "server/detect/checkerboard/corner_refine.h"
#include "server/detect/markers/marker_layout.h"
#include "server/detect/markers/tag_edges.h"

namespace rigcal::detect {
namespace {

constexpr std::size_t kTagsMin = 2;  // of a grid
constexpr std::array<int, 2> kBorderBits = {1, 2};

struct Sight {
  std::vector<PlacedMarker> tags;
  std::vector<SeenMarker> seen;
  int border_bits = 1, strangers = 0;
};

// OpenCV has the AprilTag families turned by half against their own drawings, which Kalibr and Rigcal print. Other tags
// of a grid tell by their places how their codes are turned, a single one does not.
int UsualTurn(const Target& target) {
  return target.kind == TargetKind::kAprilGrid && target.dictionary.find("APRILTAG") != std::string::npos ? 2 : 0;
}

// Of the four turns of the codes the one in which most tags agree, of equals the usual one.
std::vector<PlacedMarker> InBestTurn(const Target& target, const MarkerLayout& layout,
                                     const std::vector<SeenMarker>& seen) {
  std::vector<PlacedMarker> best;
  for (int k = 0; k < 4; ++k) {
    std::vector<PlacedMarker> placed = Placed(layout, seen, (UsualTurn(target) + k) % 4);
    if (placed.size() > best.size()) best = std::move(placed);
  }
  return best;
}

// In one width of border, until all tags are found.
Sight SightOf(const GreyImage& image, const Target& target, const MarkerLayout& layout, int border_bits,
              bool from_behind) {
  Sight sight;
  sight.border_bits = border_bits;
  for (const double scale : MarkerScales(image))
    for (const int separate_px : scale > 1 ? std::vector<int>{1, 2} : std::vector<int>{1, 0}) {
      const FoundMarkers found =
          FindMarkers(image, {target.dictionary, MarkerIdsOf(target), border_bits, scale, from_behind, separate_px});
      Join(sight.seen, found.markers);
      sight.strangers = std::max(sight.strangers, found.strangers);
      sight.tags = InBestTurn(target, layout, sight.seen);
      if (sight.tags.size() == layout.quads.size()) return sight;
    }
  return sight;
}

Sight BestSight(const GreyImage& image, const Target& target, const MarkerLayout& layout, bool from_behind) {
  Sight best;
  for (const int border_bits : kBorderBits) {
    Sight sight = SightOf(image, target, layout, border_bits, from_behind);
    const int strangers = std::max(sight.strangers, best.strangers);
    if (std::pair(sight.tags.size(), sight.seen.size()) > std::pair(best.tags.size(), best.seen.size()))
      best = std::move(sight);
    best.strangers = strangers;
    if (best.tags.size() == layout.quads.size()) break;
  }
  return best;
}

// Are the tags numbered as on the other kind of grid?
bool OtherNumbering(const Target& target, const Sight& sight) {
  Target other = target;
  other.kind = target.kind == TargetKind::kAprilGrid ? TargetKind::kArucoGrid : TargetKind::kAprilGrid;
  return InBestTurn(other, GridLayout(other), sight.seen).size() > sight.tags.size();
}

std::size_t TagsNeeded(const Target& target) {
  return std::min(kTagsMin, static_cast<std::size_t>(MarkerCountOf(target)));
}

bool AreCredible(const Target& target, const Sight& sight) {
  return Credible(sight.tags.size(), sight.seen.size(), TagsNeeded(target));
}

bool IsBoard(const Target& target, const Sight& sight) {
  return AreCredible(target, sight) && !OtherNumbering(target, sight);
}

std::vector<BoardCorner> Corners(const GreyImage& image, const Target& target, const Sight& sight) {
  const int cells = *BitsAcross(target.dictionary) + 2 * sight.border_bits;
  const double clear_ratio = std::min(static_cast<double>(sight.border_bits) / cells, target.spacing_ratio);
  std::vector<BoardCorner> corners;
  for (const PlacedMarker& tag : sight.tags) {
    const auto sharp = SharpCorners(image, tag.corners_px, clear_ratio);
    for (std::size_t i = 0; i < 4; ++i)
      if (sharp[i]) corners.push_back({4 * tag.place + static_cast<int>(i), tag.board_m[i], *sharp[i]});
  }
  return Consistent(corners, target.square_m * (1 + target.spacing_ratio));
}

std::string WhyNot(const Target& target, const Sight& sight, std::size_t corners) {
  const std::string board =
      "no grid of " + std::to_string(target.cols) + " x " + std::to_string(target.rows) + " tags in the picture";
  if (sight.seen.empty() && sight.strangers > 0)
    return board + "; the " + std::to_string(sight.strangers) + " tags in it have ids that this board does not have";
  if (sight.seen.empty())
    return board + "; no tag of " + target.dictionary + " was read: show the board sharp and evenly lit";
  if (OtherNumbering(target, sight))
    return board + (target.kind == TargetKind::kAprilGrid
                        ? "; its tags are numbered from the top left: set type: aruco_grid"
                        : "; its tags are numbered from the bottom left: set type: april_grid");
  if (MarkerCountOf(target) == 1 && sight.seen.size() > 1)
    return board + "; its tag is in it " + std::to_string(sight.seen.size()) + " times: cover the others";
  if (!AreCredible(target, sight))
    return board + "; the tags read (" + std::to_string(sight.seen.size()) +
           ") are not placed as on it: check tags, spacing_ratio and dictionary";
  return board + "; " + std::to_string(corners) + " corners of its tags can be seen, and at least " +
         std::to_string(4 * TagsNeeded(target)) + " are needed";
}

}  // namespace

void FindTagGrid(const GreyImage& image, const Target& target, BoardView& view) {
  const MarkerLayout layout = GridLayout(target);
  MarkerSearch glance{target.dictionary, MarkerIdsOf(target)};
  glance.separate_px = 1;
  if (!AnyMarkers(image, glance, kBorderBits)) {
    view.why_not = WhyNot(target, {}, 0);
    return;
  }
  Sight sight = BestSight(image, target, layout, false);
  if (!AreCredible(target, sight))
    if (Sight behind = BestSight(image, target, layout, true); IsBoard(target, behind)) sight = std::move(behind);
  std::vector<BoardCorner> corners;
  if (IsBoard(target, sight)) corners = Corners(image, target, sight);
  if (!SpreadEnough(corners, 4 * TagsNeeded(target))) {
    view.why_not = WhyNot(target, sight, corners.size());
    return;
  }
  Show(corners, view);
}

}  // namespace rigcal::detect

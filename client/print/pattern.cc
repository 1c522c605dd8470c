#include "client/print/pattern.h"

#include "client/print/marker.h"

namespace rigcal::print {
namespace {

// Black cells that lie beside each other are one rectangle.
void AddMarker(const Marker& marker, double x_m, double y_m, double side_m, std::vector<Rectangle>& black) {
  const double cell_m = side_m / marker.cells;
  for (int row = 0; row < marker.cells; ++row) {
    const auto is_black = [&](int col) {
      return col < marker.cells && marker.is_black[static_cast<std::size_t>(row * marker.cells + col)];
    };
    for (int col = 0; col < marker.cells; ++col) {
      if (!is_black(col)) continue;
      const int first = col;
      while (is_black(col + 1)) ++col;
      black.push_back({x_m + first * cell_m, y_m + row * cell_m, (col + 1 - first) * cell_m, cell_m});
    }
  }
}

bool IsBlackSquare(const Target& target, int row, int col) {
  const bool first_is_white = target.kind == TargetKind::kCharuco && target.legacy_layout && target.rows % 2 == 1;
  return ((row + col) % 2 == 0) != first_is_white;
}

// rows and cols of a target are its inner corners: it has one square more each way.
Result<Pattern> DrawSquares(const Target& target) {
  const double side_m = target.square_m, inset_m = (side_m - target.marker_m) / 2;
  const bool has_markers = target.kind == TargetKind::kCharuco;
  Pattern pattern{(target.cols + 1) * side_m, (target.rows + 1) * side_m, {}, {}};
  std::vector<Marker> markers;
  if (has_markers) {
    RIGCAL_ASSIGN(markers, MarkersOf(target.kind, target.dictionary, MarkerIdsOf(target)));
  }
  std::size_t next = 0;
  for (int row = 0; row <= target.rows; ++row)
    for (int col = 0; col <= target.cols; ++col) {
      const double x_m = col * side_m, y_m = row * side_m;
      if (IsBlackSquare(target, row, col))
        pattern.black.push_back({x_m, y_m, side_m, side_m});
      else if (has_markers)
        AddMarker(markers[next++], x_m + inset_m, y_m + inset_m, target.marker_m, pattern.black);
    }
  return pattern;
}

// Numbered from the bottom left with dark squares where gaps meet (Kalibr's), or from the top left without.
Result<Pattern> DrawTags(const Target& target) {
  const bool is_april = target.kind == TargetKind::kAprilGrid;
  const double side_m = target.square_m, gap_m = side_m * target.spacing_ratio, pitch_m = side_m + gap_m;
  const double edge_m = is_april ? gap_m : 0.0;
  RIGCAL_ASSIGN(const auto tags, MarkersOf(target.kind, target.dictionary, MarkerIdsOf(target)));
  Pattern pattern{target.cols * pitch_m - gap_m + 2 * edge_m, target.rows * pitch_m - gap_m + 2 * edge_m, {}, {}};
  for (int row = 0; row < target.rows; ++row)
    for (int col = 0; col < target.cols; ++col) {
      const int id = (is_april ? target.rows - 1 - row : row) * target.cols + col;
      AddMarker(tags[static_cast<std::size_t>(id)], edge_m + col * pitch_m, edge_m + row * pitch_m, side_m,
                pattern.black);
    }
  for (int row = 0; is_april && row <= target.rows; ++row)
    for (int col = 0; col <= target.cols; ++col) pattern.black.push_back({col * pitch_m, row * pitch_m, gap_m, gap_m});
  return pattern;
}

Pattern DrawCircles(const Target& target) {
  const Eigen::Vector2d size_m = PatternSize_m(target);
  Pattern pattern{size_m.x(), size_m.y(), {}, {}};
  const double inset_m = target.diameter_m / 2;
  for (const Eigen::Vector3d& centre : TargetPoints(target))
    pattern.discs.push_back({centre.x() + inset_m, centre.y() + inset_m, target.diameter_m});
  return pattern;
}

}  // namespace

Result<Pattern> DrawPattern(const Target& target) {
  if (IsCircleGrid(target.kind)) return DrawCircles(target);
  return IsTagGrid(target.kind) ? DrawTags(target) : DrawSquares(target);
}

}  // namespace rigcal::print

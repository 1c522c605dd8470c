// Searches square markers of a dictionary.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

// Corners to about a pixel; the first is the top left one of the marker as OpenCV draws it. Clockwise in the picture,
// unless seen from behind.
struct SeenMarker {
  int place = 0;  // which of the board's markers, as MarkerSearch::ids has them
  std::array<Eigen::Vector2d, 4> corners_px;
};

struct MarkerSearch {
  std::string dictionary;     // OpenCV's name
  std::vector<int> ids = {};  // of the board's markers, each once; others are of other boards
  int border_bits = 1;        // width of a marker's dark border
  double scale = 1.0;         // of the picture in which to search
  bool from_behind = false;   // through the board, or printed on its back so: codes are mirrored
  int separate_px = 0;        // where markers touch other dark squares at their corners: how far to part them, in the
                              // searched picture
};

// Bits along a side without the border; nothing if there is no such dictionary.
[[nodiscard]] std::optional<int> BitsAcross(const std::string& dictionary);
// How many ids it has; 0 if there is no such dictionary.
[[nodiscard]] int IdCount(const std::string& dictionary);
// The scales at which pictures of this size are worth searching, the first one first.
[[nodiscard]] std::vector<double> MarkerScales(const GreyImage& image);

// Also white on black. Those of the board, sorted by which it is and where; `strangers` counts the others. Markers with
// sides from 12 px, or 1 % of a large picture's width. Throws what OpenCV throws.
struct FoundMarkers {
  std::vector<SeenMarker> markers;
  int strangers = 0;
};
// Nothing where OpenCV does not know the dictionary.
[[nodiscard]] FoundMarkers FindMarkers(const GreyImage& image, const MarkerSearch& search);
// A quick look at a large picture, in all widths of border, from the front and from behind: can FindMarkers() find two
// of them, or the one that there is? True for small pictures, in which that one is quick. Squares that clutter makes do
// not count, unless they read like codes. Throws what OpenCV throws.
[[nodiscard]] bool AnyMarkers(const GreyImage& image, const MarkerSearch& search, std::span<const int> border_bits);
// Adds what `more` has where `markers` has none of the same.
void Join(std::vector<SeenMarker>& markers, const std::vector<SeenMarker>& more);

}  // namespace rigcal::detect

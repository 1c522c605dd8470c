#include "server/detect/markers/markers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "server/detect/markers/marker_code.h"

namespace rigcal::detect {
namespace {

constexpr double kSideMin_px = 12;
constexpr double kSideMinRatio = 0.01;  // of a large picture's longer side: a bound on the number of candidates
// The first pass has one window: the one that shows some of the markers of a board at every size, blur and tilt at
// which the search shows them.
constexpr int kFirstPassWindow_px = 9;
constexpr double kFirstPassScale = 0.5;  // for large, blurred ones; and the picture itself
// So many ids are worth a search: clutter that reads like a short code is not rare, but mostly a single one.
constexpr std::size_t kFirstPassShort = 2, kFirstPassLong = 1, kFirstPassStrangers = 4;
constexpr int kLongBits = 5;  // across
constexpr int kEnlargeSide_px = 1600, kReduceSide_px = 2400, kFullSide_px = 6000;

using Quad = std::array<Eigen::Vector2d, 4>;

cv::Ptr<cv::aruco::DetectorParameters> Parameters(const MarkerSearch& search, int side_px) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  parameters->detectInvertedMarker = true;
  parameters->markerBorderBits = search.border_bits;
  parameters->minMarkerPerimeterRate = 4 * std::max(kSideMin_px * search.scale / side_px, kSideMinRatio);
  parameters->minDistanceToBorder = 1;
  return parameters;
}

cv::Mat Searched(const GreyImage& image, const MarkerSearch& search) {
  // OpenCV only reads, yet its wrapper for memory takes a mutable pointer.
  const cv::Mat grey(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat searched = grey;
  if (search.scale != 1.0)
    cv::resize(grey, searched, {}, search.scale, search.scale, search.scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  if (search.from_behind) {
    cv::Mat mirrored;
    cv::flip(searched, mirrored, 1);
    searched = mirrored;
  }
  return searched;
}

cv::Mat Parted(const cv::Mat& searched, int separate_px) {
  if (separate_px <= 0) return searched;
  cv::Mat parted;
  const int side_px = 2 * separate_px + 1;
  cv::dilate(searched, parted, cv::getStructuringElement(cv::MORPH_RECT, {side_px, side_px}));
  return parted;
}

// From the middles of the outermost dark pixels to where the dark ends.
Quad Grown(const std::vector<cv::Point2f>& corners, int separate_px) {
  Quad quad;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    quad[i] = {corners[i].x, corners[i].y};
    centre += quad[i] / 4;
  }
  const double side_px = ((quad[0] - quad[2]).norm() + (quad[1] - quad[3]).norm()) / (2 * std::sqrt(2.0));
  const double lost_px = 1 + 2 * separate_px;
  for (Eigen::Vector2d& corner : quad) corner = centre + (corner - centre) * (1 + lost_px / side_px);
  return quad;
}

// Back to the picture's pixels; `width_px` of the searched one.
SeenMarker Unscaled(int id, const Quad& quad, const MarkerSearch& search, int width_px) {
  SeenMarker marker{id, quad};
  for (Eigen::Vector2d& corner : marker.corners_px) {
    if (search.from_behind) corner.x() = width_px - 1 - corner.x();
    corner = (corner.array() + 0.5) / search.scale - 0.5;
  }
  return marker;
}

// Dark at that window. Dark pixels that have no dark one beside them are noise, tens of thousands of outlines, and no
// marker's.
cv::Mat DarkParts(const cv::Mat& grey) {
  constexpr double kDarker_grey = 7;  // than around it: as OpenCV's search of markers
  cv::Mat dark, near;
  cv::adaptiveThreshold(grey, dark, 1, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, kFirstPassWindow_px,
                        kDarker_grey);
  cv::boxFilter(dark, near, CV_8U, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::threshold(near, near, 1, 1, cv::THRESH_BINARY);
  cv::bitwise_and(dark, near, dark);
  return dark;
}

// All those that OpenCV's search finds, before it asks what is in them. In either sense of turning.
std::vector<std::vector<cv::Point2f>> SquaresIn(const cv::Mat& searched) {
  constexpr double kOffRatio = 0.03;  // of the outline: how far a side may bend; as OpenCV's search
  std::vector<std::vector<cv::Point>> outlines;
  const double longest_px = 4 * std::max(searched.cols, searched.rows);
  cv::findContours(DarkParts(searched), outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  std::vector<std::vector<cv::Point2f>> squares;
  for (const auto& outline : outlines) {
    const auto length_px = static_cast<double>(outline.size());
    if (length_px < 4 * kSideMin_px || length_px > longest_px) continue;
    std::vector<cv::Point> corners;
    cv::approxPolyDP(outline, corners, kOffRatio * length_px, true);
    if (corners.size() == 4 && cv::isContourConvex(corners)) squares.emplace_back(corners.begin(), corners.end());
  }
  return squares;
}

// Of each code of a dictionary, which of the board's markers has it; -1: none.
std::vector<int> PlacesOf(const std::vector<int>& ids, int code_count) {
  std::vector<int> places(static_cast<std::size_t>(code_count), -1);
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (ids[i] >= 0 && ids[i] < code_count) places[static_cast<std::size_t>(ids[i])] = static_cast<int>(i);
  return places;
}

Eigen::Vector2d CentreOf(const SeenMarker& marker) {
  return (marker.corners_px[0] + marker.corners_px[1] + marker.corners_px[2] + marker.corners_px[3]) / 4;
}

}  // namespace

bool AnyMarkers(const GreyImage& image, const MarkerSearch& search, std::span<const int> border_bits) {
  if (std::max(image.width_px, image.height_px) <= kReduceSide_px) return true;
  const auto dictionary = DictionaryOf(search.dictionary);
  if (!dictionary) return false;
  const CodeTable table = TableOf(*dictionary);
  const std::vector<int> places = PlacesOf(search.ids, dictionary->bytesList.rows);
  const std::size_t enough =
      std::min(search.ids.size(), dictionary->markerSize >= kLongBits ? kFirstPassLong : kFirstPassShort);
  std::set<int> ids, strangers;
  std::vector<std::pair<double, int>> passes = {{kFirstPassScale, 0}, {1.0, 0}};
  if (search.separate_px > 0) passes.emplace_back(1.0, search.separate_px);
  for (const auto& [scale, separate_px] : passes) {
    MarkerSearch of_pass = search;
    of_pass.scale = scale, of_pass.separate_px = separate_px;
    const cv::Mat searched = Searched(image, of_pass);
    for (const auto& quad : SquaresIn(Parted(searched, separate_px))) {
      for (const int id : IdsOf(searched, Grown(quad, separate_px), dictionary->markerSize, table, border_bits))
        (places[static_cast<std::size_t>(id)] >= 0 ? ids : strangers).insert(id);
      if (ids.size() >= enough || strangers.size() >= kFirstPassStrangers) return true;
    }
  }
  return false;
}

std::optional<int> BitsAcross(const std::string& dictionary) {
  const auto known = DictionaryOf(dictionary);
  return known ? std::optional<int>(known->markerSize) : std::nullopt;
}

int IdCount(const std::string& dictionary) {
  const auto known = DictionaryOf(dictionary);
  return known ? known->bytesList.rows : 0;
}

std::vector<double> MarkerScales(const GreyImage& image) {
  const int side_px = std::max(image.width_px, image.height_px);
  std::vector<double> scales;
  if (side_px <= kFullSide_px) scales.push_back(1.0);
  if (side_px <= kEnlargeSide_px) scales.push_back(2.0);
  if (side_px > kReduceSide_px) scales.push_back(static_cast<double>(kEnlargeSide_px) / side_px);
  return scales;
}

FoundMarkers FindMarkers(const GreyImage& image, const MarkerSearch& search) {
  const auto dictionary = DictionaryOf(search.dictionary);
  FoundMarkers found;
  if (!dictionary) return found;
  const cv::Mat searched = Searched(image, search);
  std::vector<std::vector<cv::Point2f>> corners, unread;
  std::vector<int> ids;
  cv::aruco::detectMarkers(Parted(searched, search.separate_px), dictionary, corners, ids,
                           Parameters(search, std::max(searched.cols, searched.rows)), unread);
  const std::vector<int> places = PlacesOf(search.ids, dictionary->bytesList.rows);
  const auto keep = [&](int id, const Quad& quad) {
    const int place = id < 0 ? -1 : places[static_cast<std::size_t>(id)];
    if (place < 0)
      ++found.strangers;
    else
      found.markers.push_back(Unscaled(place, quad, search, searched.cols));
  };
  for (std::size_t i = 0; i < ids.size(); ++i) keep(ids[i], Grown(corners[i], search.separate_px));
  // Squares whose codes OpenCV did not read. Parting thins the dark cells of a code: it is read where nothing was
  // parted.
  for (const auto& quad : unread)
    if (const auto code = ReadCode(searched, Grown(quad, search.separate_px), *dictionary, search.border_bits))
      keep(code->id, code->corners_px);
  const auto order = [](const SeenMarker& marker) {
    return std::make_tuple(marker.place, marker.corners_px[0].y(), marker.corners_px[0].x());
  };
  std::sort(found.markers.begin(), found.markers.end(),
            [&](const SeenMarker& a, const SeenMarker& b) { return order(a) < order(b); });
  return found;
}

void Join(std::vector<SeenMarker>& markers, const std::vector<SeenMarker>& more) {
  const std::size_t before = markers.size();
  for (const SeenMarker& marker : more) {
    const double near_px = (marker.corners_px[0] - marker.corners_px[2]).norm() / 2;
    const bool known = std::any_of(
        markers.begin(), markers.begin() + static_cast<std::ptrdiff_t>(before), [&](const SeenMarker& other) {
          return other.place == marker.place && (CentreOf(other) - CentreOf(marker)).norm() < near_px;
        });
    if (!known) markers.push_back(marker);
  }
}

}  // namespace rigcal::detect

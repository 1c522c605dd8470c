#include "client/print/marker.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/aruco/dictionary.hpp>
#include <opencv2/core.hpp>

namespace rigcal::print {
namespace {

// In the order of OpenCV's PREDEFINED_DICTIONARY_NAME.
constexpr std::array<const char*, 21> kDictionaryNames = {
    "DICT_4X4_50",        "DICT_4X4_100",        "DICT_4X4_250",       "DICT_4X4_1000",      "DICT_5X5_50",
    "DICT_5X5_100",       "DICT_5X5_250",        "DICT_5X5_1000",      "DICT_6X6_50",        "DICT_6X6_100",
    "DICT_6X6_250",       "DICT_6X6_1000",       "DICT_7X7_50",        "DICT_7X7_100",       "DICT_7X7_250",
    "DICT_7X7_1000",      "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10",
    "DICT_APRILTAG_36h11"};

bool IsAprilFamily(const std::string& dictionary) { return dictionary.find("APRILTAG") != std::string::npos; }

// OpenCV has the AprilTag families turned by 180 degrees against their own drawings, which Kalibr prints.
Marker MarkerOf(const cv::aruco::Dictionary& dictionary, int id, int border, bool turned) {
  cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.row(id), dictionary.markerSize);
  if (turned) cv::rotate(bits, bits, cv::ROTATE_180);
  Marker marker;
  marker.cells = bits.cols + 2 * border;
  marker.is_black.assign(static_cast<std::size_t>(marker.cells * marker.cells), true);
  for (int row = 0; row < bits.rows; ++row)
    for (int col = 0; col < bits.cols; ++col)
      marker.is_black[static_cast<std::size_t>((row + border) * marker.cells + col + border)] =
          bits.at<std::uint8_t>(row, col) == 0;
  return marker;
}

}  // namespace

Result<std::vector<Marker>> MarkersOf(TargetKind kind, const std::string& dictionary, const std::vector<int>& ids) {
  const auto known = std::find(kDictionaryNames.begin(), kDictionaryNames.end(), dictionary);
  if (known == kDictionaryNames.end())
    return Fail(ErrorCode::kInvalidInput, "dictionary '" + dictionary + "' is not known",
                "Name the markers' dictionary as OpenCV does, such as DICT_5X5_100 or DICT_APRILTAG_36h11.");
  const auto all = cv::aruco::getPredefinedDictionary(static_cast<int>(known - kDictionaryNames.begin()));
  if (static_cast<int>(ids.size()) > all->bytesList.rows)
    return Fail(ErrorCode::kInvalidInput,
                "the board needs " + std::to_string(ids.size()) + " markers, and " + dictionary + " has " +
                    std::to_string(all->bytesList.rows),
                "Take a larger dictionary with --dictionary, or a board of fewer squares.");
  const auto last = std::max_element(ids.begin(), ids.end());
  if (last != ids.end() && *last >= all->bytesList.rows)
    return Fail(ErrorCode::kInvalidInput,
                "the board needs a marker of id " + std::to_string(*last) + ", and " + dictionary + " ends at " +
                    std::to_string(all->bytesList.rows - 1),
                "Take a larger dictionary with --dictionary, or a lower --first-id.");
  const bool is_april_grid = kind == TargetKind::kAprilGrid;
  std::vector<Marker> markers;
  for (const int id : ids)
    markers.push_back(MarkerOf(*all, id, is_april_grid ? 2 : 1, is_april_grid && IsAprilFamily(dictionary)));
  return markers;
}

}  // namespace rigcal::print

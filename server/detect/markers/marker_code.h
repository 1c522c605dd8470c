// Dictionaries, and the code in a square. Shows OpenCV, and is for markers.cc only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/aruco/dictionary.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/detect/markers/code_table.h"

namespace rigcal::detect {

// Null: there is no such dictionary.
[[nodiscard]] cv::Ptr<cv::aruco::Dictionary> DictionaryOf(const std::string& name);

struct ReadMarker {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px;  // the first is the top left one of the marker as OpenCV draws it
};

// Of a dark or light border of `border_bits` cells around a code of the dictionary, within `corners_px` (clockwise from
// any corner). Nothing if the border is broken or the code is not in the dictionary. Throws what OpenCV throws.
[[nodiscard]] std::optional<ReadMarker> ReadCode(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px,
                                                 const cv::aruco::Dictionary& dictionary, int border_bits);
// The dictionary for IdsOf(), which asks of many squares.
[[nodiscard]] CodeTable TableOf(const cv::aruco::Dictionary& dictionary);
[[nodiscard]] CodeBits PackedBits(const cv::Mat& bits);
// The ids that ReadCode() reads with borders of these widths (the narrowest first), from the front and from behind.
[[nodiscard]] std::vector<int> IdsOf(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px,
                                     int bits_across, const CodeTable& table, std::span<const int> border_bits);

}  // namespace rigcal::detect

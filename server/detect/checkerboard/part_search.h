// The thorough search of a checkerboard of which a part was seen.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/detect/checkerboard/board_search.h"

namespace rigcal::detect {

// Looks around the part, in pictures of it in which squares have the same few sizes whatever the picture's: other
// samplings of the same blur and noise often show the corners that one hid, and the work is bounded. For corners.cc
// only. Row-major, to about half a pixel of those pictures. Empty: not found. Throws what OpenCV throws.
[[nodiscard]] std::vector<cv::Point2f> SearchAround(const cv::Mat& image, const GridPart& part, const cv::Size& counts);

}  // namespace rigcal::detect

// The cloud in a camera's picture: the plainest check of a lidar-camera pose.
#pragma once

#include <string>

#include "server/cloud/camera_view.h"

namespace rigcal::cloud {

struct Overlay {
  std::string points_jpg;   // the picture, dimmed, with the points that nothing hides, coloured by their distance
  std::string picture_jpg;  // the same picture, plain
};

// Both at most 1600 px wide and of the same size. Colours go with the logarithm of the distance, along a map of even
// steps to the eye; a bar says which is which. The same input gives the same bytes. Throws what OpenCV throws.
[[nodiscard]] Overlay OverlayOf(const Picture& picture, const CameraView& view);

}  // namespace rigcal::cloud

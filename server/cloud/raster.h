// A picture of points with a depth for every pixel.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "server/cloud/camera_view.h"

namespace rigcal::cloud {

class Raster {
 public:
  // All background, infinitely far away.
  Raster(int width_px, int height_px);

  // A disc of pixels, of those that lie nearer than what is there. `place`: x, y in pixels, depth.
  void Disc(const Eigen::Vector3f& place, float radius_px, const Rgb& rgb);
  // Darkens what lies behind its neighbours: edges of depth are seen, even surfaces stay as they are. `unit_m`: the
  // depth at which half of the light is lost.
  void ShadeEdges(float unit_m, int reach_px);
  // The points over the background, in BGR, halved in size: each pixel the mean of four.
  [[nodiscard]] cv::Mat Halved(const cv::Scalar& top, const cv::Scalar& bottom) const;

 private:
  cv::Mat1f depth_;  // infinite: background
  cv::Mat3b bgr_;
};

}  // namespace rigcal::cloud

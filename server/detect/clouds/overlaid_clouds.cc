#include "server/detect/clouds/overlaid_clouds.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace rigcal::detect {
namespace {

constexpr int kSide_px = 620, kGap_px = 8, kBarHeight_px = 34, kJpegQuality = 90;
const cv::Scalar kDark(28, 24, 22), kText(215, 215, 215);
const cv::Vec3b kBlue(235, 150, 60), kOrange(40, 140, 255);

// Half the side of the square about a sensor that holds nine tenths of its points.
double Half_m(const std::vector<Eigen::Vector3f>& points_m) {
  if (points_m.empty()) return 10;
  std::vector<float> reach_m;
  for (const Eigen::Vector3f& p : points_m) reach_m.push_back(std::max(std::abs(p.x()), std::abs(p.y())));
  const auto far = reach_m.begin() + static_cast<std::ptrdiff_t>(reach_m.size() * 9 / 10);
  std::nth_element(reach_m.begin(), far, reach_m.end());
  return std::clamp(1.05 * *far, 1.0, 200.0);
}

// x up, y to the left, as a map with the robot looking up. Colours of points in one pixel add up.
void Draw(const std::vector<Eigen::Vector3f>& points_m, const Se3& T_a_cloud, double half_m, const cv::Vec3b& colour,
          cv::Mat picture) {
  const double per_m = kSide_px / (2 * half_m);
  for (const Eigen::Vector3f& point : points_m) {
    const Eigen::Vector3d p = T_a_cloud * Eigen::Vector3d(point.cast<double>());
    const Eigen::Vector2d at((half_m - p.y()) * per_m, (half_m - p.x()) * per_m);
    if (!(at.minCoeff() >= 0 && at.maxCoeff() < kSide_px)) continue;
    cv::Vec3b& pixel = picture.at<cv::Vec3b>(static_cast<int>(at.y()), static_cast<int>(at.x()));
    for (int c = 0; c < 3; ++c) pixel[c] = cv::saturate_cast<std::uint8_t>(pixel[c] + 0.7 * colour[c]);
  }
}

void Caption(const std::string& text, int x_px, cv::Mat& picture) {
  cv::putText(picture, text, {x_px + 10, picture.rows - 11}, cv::FONT_HERSHEY_SIMPLEX, 0.55, kText, 1, cv::LINE_AA);
}

}  // namespace

std::string OverlaidClouds(const std::vector<Eigen::Vector3f>& a_m, const std::vector<Eigen::Vector3f>& b_m,
                           const Se3& T_a_b_before, const Se3& T_a_b_after) {
  cv::Mat picture(kSide_px + kBarHeight_px, 2 * kSide_px + kGap_px, CV_8UC3, kDark);
  const double half_m = std::min(Half_m(a_m), Half_m(b_m));  // what both see is about the one that sees less far
  int x_px = 0;
  for (const Se3* T_a_b : {&T_a_b_before, &T_a_b_after}) {
    cv::Mat side = picture(cv::Rect(x_px, 0, kSide_px, kSide_px));
    side.setTo(cv::Scalar::all(10));
    Draw(a_m, Se3(), half_m, kBlue, side);
    Draw(b_m, *T_a_b, half_m, kOrange, side);
    x_px += kSide_px + kGap_px;
  }
  char size[64];
  std::snprintf(size, sizeof size, "found (%.0f m across)", 2 * half_m);
  Caption("nominal pose", 0, picture);
  Caption(size, kSide_px + kGap_px, picture);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return std::string(jpeg.begin(), jpeg.end());
}

}  // namespace rigcal::detect

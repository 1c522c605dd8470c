#include "client/moments/picture_watcher.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "client/check/edge_width.h"
#include "server/detect/board.h"

namespace rigcal::moments {
namespace {

constexpr std::int64_t kSearchEvery_ns = 200'000'000, kSearchAnew_ns = 1'000'000'000, kFollowGap_ns = 400'000'000;
constexpr int kPyramidLevels = 3, kFollowWindow_px = 15;
constexpr double kThereAndBack_px = 0.5, kOntoSaddle_px = 1.5;
constexpr std::uint8_t kBrightest_grey = 253;
constexpr float kOffMiddle = 0.37F;

using Points = std::vector<cv::Point2f>;

cv::Mat MatOf(const detect::GreyImage& image) {
  return {image.height_px, image.width_px, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};  // read only
}

Points PointsOf(const BoardView& view) {
  Points points;
  for (const Eigen::Vector2d& corner : view.corners_px)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  return points;
}

// Least distance of two corners that are neighbours in the list.
double Pitch_px(const Points& points) {
  double least = 1e9;
  for (std::size_t i = 1; i < points.size(); ++i) least = std::min(least, cv::norm(points[i] - points[i - 1]));
  return least;
}

bool AreNear(const Points& a, const Points& b, double most_px) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(cv::norm(a[i] - b[i]) <= most_px)) return false;
  return true;
}

bool AreInside(const Points& points, const cv::Mat& picture, float border_px) {
  return std::all_of(points.begin(), points.end(), [&](const cv::Point2f& point) {
    return point.x >= border_px && point.y >= border_px && point.x < static_cast<float>(picture.cols) - border_px &&
           point.y < static_cast<float>(picture.rows) - border_px;
  });
}

// Where the points of one picture are in the next; empty: one was lost.
Points Followed(const cv::Mat& from, const cv::Mat& to, const Points& points) {
  Points there, back;
  std::vector<unsigned char> status;
  std::vector<float> error;
  const cv::Size window(kFollowWindow_px, kFollowWindow_px);
  cv::calcOpticalFlowPyrLK(from, to, points, there, status, error, window, kPyramidLevels);
  if (std::find(status.begin(), status.end(), 0) != status.end()) return {};
  cv::calcOpticalFlowPyrLK(to, from, there, back, status, error, window, kPyramidLevels);
  if (std::find(status.begin(), status.end(), 0) != status.end() || !AreNear(points, back, kThereAndBack_px)) return {};
  const int half = std::clamp(static_cast<int>(0.3 * Pitch_px(there)), 2, 5);
  if (!AreInside(there, to, static_cast<float>(half + 2))) return {};
  Points settled = there;
  cv::cornerSubPix(to, settled, {half, half}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.005});
  return AreNear(there, settled, kOntoSaddle_px) ? settled : Points();
}

// Side of a square of the board, or of its tags, over its side in the picture: of neighbouring points.
double MetresPerPixel(const BoardView& view, const std::vector<Eigen::Vector3d>& points_m) {
  double sum_m = 0, sum_px = 0;
  for (std::size_t i = 1; i < view.corners_px.size(); ++i) {
    const auto at = [&](std::size_t k) { return points_m[static_cast<std::size_t>(view.corner_idx[k])]; };
    sum_m += (at(i) - at(i - 1)).norm();
    sum_px += (view.corners_px[i] - view.corners_px[i - 1]).norm();
  }
  return sum_px > 0 ? sum_m / sum_px : 0.0;
}

void KeepCorners(const BoardView& view, std::size_t of_target, Sight& sight) {
  const std::size_t stride = std::max<std::size_t>(1, (of_target + kCornersKept - 1) / kCornersKept);
  for (std::size_t i = 0; i < view.corner_idx.size(); ++i) {
    if (static_cast<std::size_t>(view.corner_idx[i]) % stride != 0) continue;
    sight.corner_idx.push_back(view.corner_idx[i]);
    sight.corners_px.push_back(view.corners_px[i].cast<float>());
  }
}

// Between all corners that are kept, off the middle: middles lie on edges.
void SetExposure(const detect::GreyImage& image, Sight& sight) {
  std::vector<std::uint8_t> greys;
  for (std::size_t i = 0; i < sight.corners_px.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2f place = sight.corners_px[i] + kOffMiddle * (sight.corners_px[j] - sight.corners_px[i]);
      greys.push_back(image.At(static_cast<int>(std::lround(place.x())), static_cast<int>(std::lround(place.y()))));
    }
  if (greys.empty()) return;
  std::sort(greys.begin(), greys.end());
  const auto brightest = std::lower_bound(greys.begin(), greys.end(), kBrightest_grey);
  sight.bright_ratio = static_cast<double>(greys.end() - brightest) / static_cast<double>(greys.size());
  sight.contrast_grey = greys[greys.size() * 9 / 10] - greys[greys.size() / 10];
}

}  // namespace

struct PictureWatcher::State {
  std::vector<const Target*> targets;
  std::vector<std::vector<Eigen::Vector3d>> points_m;  // of each target
  detect::GreyImage last;
  std::int64_t last_ns = 0, searched_ns = INT64_MIN / 2;
  BoardView view;  // of `last`; not found: nothing to follow
  int target_idx = -1;

  bool Follow(const detect::GreyImage& image, std::int64_t stamp_ns) {
    if (target_idx < 0 || std::abs(stamp_ns - last_ns) > kFollowGap_ns || image.width_px != last.width_px ||
        image.height_px != last.height_px)
      return false;
    const Points points = Followed(MatOf(last), MatOf(image), PointsOf(view));
    for (std::size_t i = 0; i < points.size(); ++i) view.corners_px[i] = {points[i].x, points[i].y};
    return !points.empty();
  }

  void Search(const detect::GreyImage& image, std::int64_t stamp_ns) {
    searched_ns = stamp_ns;
    target_idx = -1;
    for (std::size_t t = 0; t < targets.size() && target_idx < 0; ++t) {
      view = detect::FindIn(image, *targets[t]);
      if (view.found) target_idx = static_cast<int>(t);
    }
  }

  [[nodiscard]] Sight Told(const detect::GreyImage& image, std::int64_t stamp_ns) const {
    Sight sight;
    sight.stamp_ns = stamp_ns;
    sight.width_px = image.width_px, sight.height_px = image.height_px;
    sight.target_idx = target_idx;
    if (target_idx < 0) return sight;
    const auto t = static_cast<std::size_t>(target_idx);
    KeepCorners(view, points_m[t].size(), sight);
    sight.m_per_px = MetresPerPixel(view, points_m[t]);
    sight.edge_px = check::EdgeWidth_px(image, view, *targets[t]);
    SetExposure(image, sight);
    return sight;
  }
};

PictureWatcher::PictureWatcher(std::vector<const Target*> targets) : state_(std::make_unique<State>()) {
  for (const Target* target : targets) state_->points_m.push_back(TargetPoints(*target));
  state_->targets = std::move(targets);
}
PictureWatcher::~PictureWatcher() = default;
PictureWatcher::PictureWatcher(PictureWatcher&&) noexcept = default;

Sight PictureWatcher::Look(detect::GreyImage image, std::int64_t stamp_ns) {
  State& state = *state_;
  const bool is_due = std::abs(stamp_ns - state.searched_ns) >= kSearchAnew_ns;
  if (is_due || !state.Follow(image, stamp_ns)) {
    const bool waits = state.target_idx < 0 && std::abs(stamp_ns - state.searched_ns) < kSearchEvery_ns;
    if (!waits) state.Search(image, stamp_ns);
  }
  Sight sight = state.Told(image, stamp_ns);
  state.last = std::move(image);
  state.last_ns = stamp_ns;
  return sight;
}

}  // namespace rigcal::moments

#include "server/detect/circles/circle_perspective.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "server/detect/circles/blobs.h"
#include "server/detect/pictures/plane_map.h"

namespace rigcal::detect {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr int kOutline = 48;  // points of a circle
constexpr int kRounds = 3;    // the map is made of what it corrects

// How many different places along an axis of the board.
int LinesAlong(const Points& board, int axis) {
  std::set<long> places;
  for (const Eigen::Vector2d& at : board) places.insert(std::lround(at[axis] * 1e6));
  return static_cast<int>(places.size());
}

// Powers of x and y up to this sum bend the homography: as many as the rows and columns tell with some to spare.
int DegreeFor(const Points& board) {
  const int lines = std::min(LinesAlong(board, 0), LinesAlong(board, 1));
  if (lines >= 5 && board.size() >= 20) return 3;
  return lines >= 4 && board.size() >= 12 ? 2 : 0;
}

class BentMap {
 public:
  static std::optional<BentMap> Fit(const Points& board, const Points& pixels, int degree) {
    BentMap map;
    auto flat = PlaneMap::Fit(board, pixels);
    if (!flat) return std::nullopt;
    map.flat_ = *flat;
    map.degree_ = degree;
    for (const Eigen::Vector2d& at : board) map.middle_ += at / static_cast<double>(board.size());
    for (const Eigen::Vector2d& at : board) map.scale_ = std::max(map.scale_, (at - map.middle_).norm());
    if (degree == 0) return map;
    const auto count = static_cast<Eigen::Index>(board.size());
    Eigen::MatrixXd powers(count, map.Powers(map.middle_).size());
    Eigen::MatrixX2d left(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto idx = static_cast<std::size_t>(i);
      const auto at_px = map.flat_.Pixel(board[idx]);
      if (!at_px) return std::nullopt;
      powers.row(i) = map.Powers(board[idx]);
      left.row(i) = (pixels[idx] - *at_px).transpose();
    }
    map.bend_ = powers.colPivHouseholderQr().solve(left);
    return map;
  }

  [[nodiscard]] std::optional<Eigen::Vector2d> Pixel(const Eigen::Vector2d& board) const {
    const auto flat_px = flat_.Pixel(board);
    if (!flat_px || degree_ == 0) return flat_px;
    return Eigen::Vector2d(*flat_px + (Powers(board) * bend_).transpose());
  }

 private:
  [[nodiscard]] Eigen::RowVectorXd Powers(const Eigen::Vector2d& board) const {
    const Eigen::Vector2d p = (board - middle_) / (scale_ > 0 ? scale_ : 1);
    Eigen::RowVectorXd powers((degree_ + 1) * (degree_ + 2) / 2);
    Eigen::Index next = 0;
    for (int sum = 0; sum <= degree_; ++sum)
      for (int of_y = 0; of_y <= sum; ++of_y) powers[next++] = std::pow(p.x(), sum - of_y) * std::pow(p.y(), of_y);
    return powers;
  }
  PlaneMap flat_;
  int degree_ = 0;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double scale_ = 0;
  Eigen::MatrixX2d bend_;
};

// From the picture of the centre to the centroid of the picture.
std::optional<Eigen::Vector2d> Shift_px(const BentMap& map, const Eigen::Vector2d& centre, double radius) {
  const auto centre_px = map.Pixel(centre);
  Points outline;
  for (int i = 0; i < kOutline; ++i) {
    const double angle = 2 * M_PI * i / kOutline;
    const auto at_px = map.Pixel(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    if (!at_px) return std::nullopt;
    outline.push_back(*at_px);
  }
  if (!centre_px) return std::nullopt;
  return Eigen::Vector2d(MomentsOf(outline).centroid - *centre_px);
}

}  // namespace

std::vector<Eigen::Vector2d> CentresFrom(const Points& board, double radius, const Points& centroids_px) {
  const int degree = DegreeFor(board);
  Points centres_px = centroids_px;
  for (int round = 0; round < kRounds; ++round) {
    const auto map = BentMap::Fit(board, centres_px, degree);
    if (!map) return centroids_px;
    for (std::size_t i = 0; i < board.size(); ++i) {
      const auto shift_px = Shift_px(*map, board[i], radius);
      if (!shift_px) return centroids_px;
      centres_px[i] = centroids_px[i] - *shift_px;
    }
  }
  return centres_px;
}

}  // namespace rigcal::detect

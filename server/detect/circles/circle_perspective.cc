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

// How a lens bends a picture about its middle: straight = middle + (seen - middle) (1 + k[0] r^2 + k[1] r^4), r in half
// diagonals of the picture.
struct Radial {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero(), k = Eigen::Vector2d::Zero();
  double unit_px = 1;
  [[nodiscard]] Eigen::Vector2d Straight(const Eigen::Vector2d& seen_px) const {
    const double r2 = ((seen_px - middle_px) / unit_px).squaredNorm();
    return middle_px + (seen_px - middle_px) * (1 + k[0] * r2 + k[1] * r2 * r2);
  }
  [[nodiscard]] Eigen::Vector2d Seen(const Eigen::Vector2d& straight_px) const {
    Eigen::Vector2d seen_px = straight_px;
    for (int round = 0; round < 30; ++round) {
      const double r2 = ((seen_px - middle_px) / unit_px).squaredNorm();
      const double factor = std::max(0.2, 1 + k[0] * r2 + k[1] * r2 * r2);
      seen_px = (seen_px + middle_px + (straight_px - middle_px) / factor) / 2;
    }
    return seen_px;
  }
};

// The board's map into a picture: a homography, the lens' radial bend, and what a polynomial finds of the rest.
class BentMap {
 public:
  static std::optional<BentMap> Fit(const Points& board, const Points& pixels, const Radial& unbent) {
    BentMap map;
    map.radial_ = unbent;
    const int degree = DegreeFor(board);
    for (int round = 0; round < kLensRounds; ++round) map.ImproveLens(board, pixels);
    auto flat = PlaneMap::Fit(board, map.Straightened(pixels));
    if (!flat) return std::nullopt;
    map.flat_ = *flat;
    return map.FitRest(board, pixels, degree) ? std::optional(map) : std::nullopt;
  }

  [[nodiscard]] std::optional<Eigen::Vector2d> Pixel(const Eigen::Vector2d& board) const {
    const auto straight_px = flat_.Pixel(board);
    if (!straight_px) return std::nullopt;
    const Eigen::Vector2d seen_px = radial_.Seen(*straight_px);
    if (degree_ == 0) return seen_px;
    return Eigen::Vector2d(seen_px + (Powers(board) * bend_).transpose());
  }

 private:
  static constexpr int kLensRounds = 4;
  // Of lenses, where the board tells nothing of them; against what circles scatter.
  static constexpr double kLensSigma = 0.5, kCircleSigma_px = 0.05;

  [[nodiscard]] Points Straightened(const Points& pixels) const {
    Points straight;
    for (const Eigen::Vector2d& at_px : pixels) straight.push_back(radial_.Straight(at_px));
    return straight;
  }
  // What the best homography leaves, and what the lens is expected to be.
  [[nodiscard]] std::optional<Eigen::VectorXd> Left(const Points& board, const Points& pixels) const {
    const Points straight = Straightened(pixels);
    const auto flat = PlaneMap::Fit(board, straight);
    if (!flat) return std::nullopt;
    Eigen::VectorXd left(2 * static_cast<Eigen::Index>(board.size()) + 2);
    for (std::size_t i = 0; i < board.size(); ++i) {
      const auto at_px = flat->Pixel(board[i]);
      if (!at_px) return std::nullopt;
      left.segment<2>(2 * static_cast<Eigen::Index>(i)) = straight[i] - *at_px;
    }
    left.tail<2>() = radial_.k * (kCircleSigma_px / kLensSigma);
    return left;
  }
  // A step of Gauss and Newton; none where it would not help.
  void ImproveLens(const Points& board, const Points& pixels) {
    constexpr double kStep = 1e-4;
    const auto here = Left(board, pixels);
    if (!here) return;
    Eigen::MatrixX2d slopes(here->size(), 2);
    const Radial before = radial_;
    for (int i = 0; i < 2; ++i) {
      radial_.k[i] += kStep;
      const auto there = Left(board, pixels);
      radial_ = before;
      if (!there) return;
      slopes.col(i) = (*there - *here) / kStep;
    }
    radial_.k -= slopes.colPivHouseholderQr().solve(*here);
    const auto after = Left(board, pixels);
    if (!after || !(after->squaredNorm() <= here->squaredNorm())) radial_ = before;
  }
  bool FitRest(const Points& board, const Points& pixels, int degree) {
    for (const Eigen::Vector2d& at : board) middle_ += at / static_cast<double>(board.size());
    for (const Eigen::Vector2d& at : board) scale_ = std::max(scale_, (at - middle_).norm());
    Eigen::MatrixX2d left(static_cast<Eigen::Index>(board.size()), 2);
    for (std::size_t i = 0; i < board.size(); ++i) {
      const auto at_px = Pixel(board[i]);
      if (!at_px) return false;
      left.row(static_cast<Eigen::Index>(i)) = (pixels[i] - *at_px).transpose();
    }
    degree_ = degree;
    if (degree == 0) return true;
    Eigen::MatrixXd powers(left.rows(), Powers(middle_).size());
    for (std::size_t i = 0; i < board.size(); ++i) powers.row(static_cast<Eigen::Index>(i)) = Powers(board[i]);
    bend_ = powers.colPivHouseholderQr().solve(left);
    return true;
  }
  [[nodiscard]] Eigen::RowVectorXd Powers(const Eigen::Vector2d& board) const {
    const Eigen::Vector2d p = (board - middle_) / (scale_ > 0 ? scale_ : 1);
    Eigen::RowVectorXd powers((degree_ + 1) * (degree_ + 2) / 2);
    Eigen::Index next = 0;
    for (int sum = 0; sum <= degree_; ++sum)
      for (int of_y = 0; of_y <= sum; ++of_y) powers[next++] = std::pow(p.x(), sum - of_y) * std::pow(p.y(), of_y);
    return powers;
  }
  Radial radial_;
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

std::vector<Eigen::Vector2d> CentresFrom(const Points& board, double radius, const Points& centroids_px,
                                         const Eigen::Vector2d& picture_px) {
  const Radial unbent{(picture_px - Eigen::Vector2d::Ones()) / 2, Eigen::Vector2d::Zero(), picture_px.norm() / 2};
  Points centres_px = centroids_px;
  for (int round = 0; round < kRounds; ++round) {
    const auto map = BentMap::Fit(board, centres_px, unbent);
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

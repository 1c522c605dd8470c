#include "server/detect/pictures/plane_map.h"

#include <Eigen/QR>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr double kRankThreshold = 1e-8;
constexpr double kDepthMin = 0.05;  // of the depth at the centre of the points that were fitted

using Points = std::vector<Eigen::Vector2d>;

Eigen::Vector2d MeanOf(const Points& points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// The factor that brings the points' mean distance from `centre` to one.
double ScaleOf(const Points& points, const Eigen::Vector2d& centre) {
  double sum = 0;
  for (const Eigen::Vector2d& point : points) sum += (point - centre).norm();
  return sum > 0 ? static_cast<double>(points.size()) / sum : 1.0;
}

}  // namespace

std::optional<PlaneMap> PlaneMap::Fit(const Points& board, const Points& pixels) {
  if (board.size() < 4 || board.size() != pixels.size()) return std::nullopt;
  PlaneMap map;
  map.board_centre_ = MeanOf(board);
  map.pixel_centre_ = MeanOf(pixels);
  map.board_scale_ = ScaleOf(board, map.board_centre_);
  map.pixel_scale_ = ScaleOf(pixels, map.pixel_centre_);
  const auto count = static_cast<Eigen::Index>(board.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * count, 8);
  Eigen::VectorXd b(2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d p = (board[static_cast<std::size_t>(i)] - map.board_centre_) * map.board_scale_;
    const Eigen::Vector2d u = (pixels[static_cast<std::size_t>(i)] - map.pixel_centre_) * map.pixel_scale_;
    A.row(2 * i) << p.x(), p.y(), 1, 0, 0, 0, -u.x() * p.x(), -u.x() * p.y();
    A.row(2 * i + 1) << 0, 0, 0, p.x(), p.y(), 1, -u.y() * p.x(), -u.y() * p.y();
    b.segment<2>(2 * i) = u;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  qr.setThreshold(kRankThreshold);
  if (qr.rank() < 8) return std::nullopt;
  const Eigen::Matrix<double, 8, 1> h = qr.solve(b);
  if (!h.allFinite()) return std::nullopt;
  map.board_part_ << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return map;
}

std::optional<Eigen::Vector2d> PlaneMap::Pixel(const Eigen::Vector2d& board) const {
  const Eigen::Vector2d scaled = (board - board_centre_) * board_scale_;
  const Eigen::Vector3d u = board_part_ * Eigen::Vector3d(scaled.x(), scaled.y(), 1);
  if (!(u.z() > kDepthMin)) return std::nullopt;
  return Eigen::Vector2d(u.head<2>() / u.z() / pixel_scale_ + pixel_centre_);
}

}  // namespace rigcal::detect

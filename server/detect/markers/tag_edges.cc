#include "server/detect/markers/tag_edges.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rigcal::detect {
namespace {

constexpr double kMargin = 0.12;  // of the side at both ends, where the corners' blur is
constexpr int kSamplesMin = 12, kSamplesMax = 60;
// Half a profile across an edge: short of half of what is clear there, as the codes' light cells blur into the border.
constexpr double kReachRatio = 0.55;
constexpr double kReachMin_px = 1.25, kReachMax_px = 3;
constexpr double kStep_px = 0.25;    // along the profile across an edge
constexpr double kBentSide_px = 30;  // sides from here on may be visibly bent by the lens
constexpr double kSlopeMin = 8;      // grey levels from one side of an edge to the other
constexpr double kOffMax_px = 0.35;  // of a sample from the fitted edge: further is dirt or a finger
constexpr double kSeenRatio = 0.6;   // of the samples that must show the edge
constexpr double kMoveMaxRatio = 0.1, kMoveMin_px = 2.5;
constexpr int kPasses = 3;

struct Sample {
  double along = 0, off_px = 0;  // 0 ... 1; outwards
};

// An edge from corner to corner: off_px(along) = c0 + c1 along + c2 along^2, across the straight line.
struct Edge {
  Eigen::Vector2d start, direction, normal;  // unit; the normal outwards
  double length_px = 0;
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();

  [[nodiscard]] double OffAt(double along) const { return bend[0] + along * (bend[1] + along * bend[2]); }
};

double Signed(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Where the grey changes most across the edge, as the mean place of the slope of the wanted sign. Nothing if there is
// none.
std::optional<double> Crossing(const GreyImage& image, const Eigen::Vector2d& at, const Eigen::Vector2d& normal,
                               double reach_px, double sign) {
  double weight = 0, moment = 0;
  const auto grey = [&](double off) { return image.Between(at.x() + off * normal.x(), at.y() + off * normal.y()); };
  double before = grey(-reach_px);
  for (double off = -reach_px + kStep_px; off <= reach_px + 1e-9; off += kStep_px) {
    const double here = grey(off), slope = std::max(0.0, sign * (here - before));
    weight += slope;
    moment += slope * (off - kStep_px / 2);
    before = here;
  }
  if (weight < kSlopeMin) return std::nullopt;
  return moment / weight;
}

Eigen::Vector3d Fitted(const std::vector<Sample>& samples, bool bent) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd A(count, bent ? 3 : 2);
  Eigen::VectorXd b(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& sample = samples[static_cast<std::size_t>(i)];
    A(i, 0) = 1;
    A(i, 1) = sample.along;
    if (bent) A(i, 2) = sample.along * sample.along;
    b[i] = sample.off_px;
  }
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  bend.head(A.cols()) = A.colPivHouseholderQr().solve(b);
  return bend;
}

// Samples around the edge as known so far, and the edge through them. False if too few show it.
bool Improve(const GreyImage& image, double reach_px, double sign, Edge& edge) {
  const int count = std::clamp(static_cast<int>(edge.length_px), kSamplesMin, kSamplesMax);
  const bool bent = edge.length_px >= kBentSide_px;
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const double along = kMargin + (1 - 2 * kMargin) * (i + 0.5) / count, off = edge.OffAt(along);
    const Eigen::Vector2d at = edge.start + along * edge.length_px * edge.direction + off * edge.normal;
    if (const auto more = Crossing(image, at, edge.normal, reach_px, sign)) samples.push_back({along, off + *more});
  }
  const auto enough = [&] { return static_cast<double>(samples.size()) >= kSeenRatio * count; };
  if (!enough()) return false;
  edge.bend = Fitted(samples, bent);
  std::erase_if(samples, [&](const Sample& s) { return std::abs(s.off_px - edge.OffAt(s.along)) > kOffMax_px; });
  if (!enough()) return false;
  edge.bend = Fitted(samples, bent);
  return edge.bend.allFinite();
}

// +1 for a dark tag on light, -1 for a light one.
double SignOf(const GreyImage& image, const std::array<Edge, 4>& edges, double reach_px) {
  double balance = 0;
  for (const Edge& edge : edges)
    for (const double along : {0.3, 0.5, 0.7}) {
      const Eigen::Vector2d at = edge.start + along * edge.length_px * edge.direction, step = reach_px * edge.normal;
      balance += image.Between((at + step).x(), (at + step).y()) - image.Between((at - step).x(), (at - step).y());
    }
  return balance >= 0 ? 1 : -1;
}

Eigen::Vector2d Meeting(const Edge& a, const Edge& b, Eigen::Vector2d at) {
  for (int step = 0; step < 5; ++step) {
    Eigen::Matrix2d normals;
    Eigen::Vector2d wanted;
    const Edge* edges[2] = {&a, &b};
    for (int i = 0; i < 2; ++i) {
      const Edge& edge = *edges[i];
      const double along = (at - edge.start).dot(edge.direction) / edge.length_px;
      normals.row(i) = edge.normal;
      wanted[i] = edge.normal.dot(edge.start) + edge.OffAt(along);
    }
    at = normals.colPivHouseholderQr().solve(wanted);
  }
  return at;
}

}  // namespace

std::array<std::optional<Eigen::Vector2d>, 4> SharpCorners(const GreyImage& image,
                                                           const std::array<Eigen::Vector2d, 4>& corners_px,
                                                           double clear_ratio) {
  std::array<std::optional<Eigen::Vector2d>, 4> sharp;
  const double turn = Signed(corners_px[1] - corners_px[0], corners_px[2] - corners_px[0]) > 0 ? 1 : -1;
  std::array<Edge, 4> edges;
  double shortest_px = HUGE_VAL;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d along = corners_px[(i + 1) % 4] - corners_px[i];
    const double length_px = along.norm();
    shortest_px = std::min(shortest_px, length_px);
    if (!(length_px > 1)) return sharp;
    const Eigen::Vector2d direction = along / length_px;
    edges[i] = {corners_px[i], direction, turn * Eigen::Vector2d(direction.y(), -direction.x()), length_px};
  }
  const double reach_px = std::clamp(kReachRatio * clear_ratio * shortest_px, kReachMin_px, kReachMax_px);
  const double sign = SignOf(image, edges, reach_px);
  std::array<bool, 4> seen;
  for (std::size_t i = 0; i < 4; ++i) {
    seen[i] = true;
    for (int pass = 0; pass < kPasses && seen[i]; ++pass) seen[i] = Improve(image, reach_px, sign, edges[i]);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (!seen[i] || !seen[(i + 3) % 4]) continue;
    const Eigen::Vector2d corner = Meeting(edges[(i + 3) % 4], edges[i], corners_px[i]);
    const double move_max_px = std::max(kMoveMin_px, kMoveMaxRatio * shortest_px);
    if (corner.allFinite() && (corner - corners_px[i]).norm() <= move_max_px) sharp[i] = corner;
  }
  return sharp;
}

}  // namespace rigcal::detect

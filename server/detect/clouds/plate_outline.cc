#include "server/detect/clouds/plate_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr int kTurns = 12, kTurnsKept = 3, kTurnsGuessed = 4;
constexpr int kRoundsMax = 40;
constexpr double kFewRays = 4;  // so many rays alone say little
constexpr int kCellsMax = 6;

// Rays that say yes (+1) or no (-1) to a surface where they pierce the plane.
struct Votes {
  Eigen::ArrayXf u_m, v_m, sign;

  explicit Votes(const std::vector<Piercing>& piercings) {
    const auto counts = [](const Piercing& piercing) { return piercing.evidence != Evidence::kFront; };
    const auto size = std::count_if(piercings.begin(), piercings.end(), counts);
    u_m.resize(size), v_m.resize(size), sign.resize(size);
    Eigen::Index i = 0;
    for (const Piercing& piercing : piercings) {
      if (!counts(piercing)) continue;
      u_m[i] = piercing.uv_m.x(), v_m[i] = piercing.uv_m.y();
      sign[i++] = piercing.evidence == Evidence::kOn ? 1.0f : -1.0f;
    }
  }
};

// Less where more votes agree with the outline; `blur_m` softens its edge. Far tails keep an edge midway between the
// surface's last and the background's first ray.
double Disagreement(const Votes& votes, const Outline& outline, double blur_m) {
  const auto c = static_cast<float>(std::cos(outline.angle_rad)), s = static_cast<float>(std::sin(outline.angle_rad));
  const Eigen::Vector2f centre = outline.centre_m.cast<float>(), half = outline.size_m.cast<float>() / 2;
  const auto squared = static_cast<float>(blur_m * blur_m);
  const float x = c * centre.x() + s * centre.y(), y = c * centre.y() - s * centre.x();
  float agreement = 0;
  constexpr Eigen::Index kBlock = 256;  // so that no memory is asked for
  for (Eigen::Index at = 0; at < votes.sign.size(); at += kBlock) {
    const Eigen::Index n = std::min(kBlock, votes.sign.size() - at);
    const auto u = votes.u_m.segment(at, n), v = votes.v_m.segment(at, n);
    Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1> depth =
        (half.x() - (c * u + s * v - x).abs()).min(half.y() - (c * v - s * u - y).abs());
    agreement += (votes.sign.segment(at, n) * depth / (depth.square() + squared).sqrt()).sum();
  }
  return -agreement;
}

struct Fit {
  Outline outline;
  double loss = 0;
};

bool IsBetter(const Fit& a, const Fit& b) { return a.loss < b.loss; }

// Moves one coordinate; false if that is no better or leaves the sizes known.
bool Improve(const Votes& votes, const PlateSize& size, double blur_m, int coordinate, double step, Fit& fit) {
  Outline moved = fit.outline;
  if (coordinate < 2) moved.centre_m[coordinate] += step;
  if (coordinate == 2) moved.angle_rad += step / (size.Diagonal_m() / 2);
  if (coordinate > 2) {
    double& side_m = moved.size_m[coordinate - 3];
    side_m = std::clamp(side_m + step, size.min_m[coordinate - 3], size.max_m[coordinate - 3]);
    if (side_m == fit.outline.size_m[coordinate - 3]) return false;
  }
  const double loss = Disagreement(votes, moved, blur_m);
  if (!(loss < fit.loss)) return false;
  fit = {moved, loss};
  return true;
}

// Pattern search with `coordinates` of: centre (2), turn, size (2).
Fit Search(const Votes& votes, const PlateSize& size, const Outline& start, double blur_m, int coordinates,
           double step_m, double step_min_m) {
  Fit fit{start, Disagreement(votes, start, blur_m)};
  for (int round = 0; round < kRoundsMax && step_m >= step_min_m; ++round) {
    bool moved = false;
    for (int k = 0; k < coordinates; ++k)
      moved |= Improve(votes, size, blur_m, k, step_m, fit) || Improve(votes, size, blur_m, k, -step_m, fit);
    if (!moved) step_m /= 2;
  }
  return fit;
}

int CoordinatesOf(const PlateSize& size) { return (size.max_m - size.min_m).maxCoeff() > 1e-6 ? 5 : 3; }

// Over how much votes are smoothed; the first step of a search, and that below which it ends.
struct Coarseness {
  double blur_m = 0.0, step_m = 0.0, step_min_m = 0.0;
};
// The best place of a plate of middle size, at each of so many turns over half a circle.
std::vector<Fit> SearchTurned(const Votes& votes, const PlateSize& size, int turns, const Coarseness& coarse) {
  std::vector<Fit> fits;
  for (int turn = 0; turn < turns; ++turn) {
    const Outline start{Eigen::Vector2d::Zero(), turn * M_PI / turns, size.Middle_m()};
    fits.push_back(Search(votes, size, start, coarse.blur_m, 2, coarse.step_m, coarse.step_min_m));
  }
  return fits;
}

double Wrapped(double angle_rad) { return angle_rad - M_PI * std::floor(angle_rad / M_PI); }

struct Tally {
  double on = 0, behind = 0, front = 0;

  void Add(Evidence evidence) { ++(evidence == Evidence::kOn ? on : evidence == Evidence::kBehind ? behind : front); }
  [[nodiscard]] double All() const { return on + behind + front; }
};

// Share of the cells of the rectangle (coarser than the beams) that show a surface.
double FillOf(const std::vector<Piercing>& piercings, const Outline& outline, const BeamSpacing& spacing) {
  const Eigen::Vector2d axis = outline.Axis(), other(-axis.y(), axis.x());
  const Eigen::Vector2d gaps(spacing.Along_m(axis), spacing.Along_m(other));
  Eigen::Vector2i cells;
  for (const int k : {0, 1})
    cells[k] = std::clamp(static_cast<int>(outline.size_m[k] / std::max(1.3 * gaps[k], 1e-6)), 2, kCellsMax);
  std::array<Tally, kCellsMax * kCellsMax> tallies;
  for (const Piercing& piercing : piercings) {
    const Eigen::Vector2d share = (outline.Local(piercing.uv_m.cast<double>()).array() / outline.size_m.array() + 0.5) *
                                  cells.cast<double>().array();
    if (!(share.minCoeff() >= 0 && share.x() < cells.x() && share.y() < cells.y())) continue;
    tallies[static_cast<std::size_t>(static_cast<int>(share.y()) * cells.x() + static_cast<int>(share.x()))].Add(
        piercing.evidence);
  }
  double filled = 0;
  for (int i = 0; i < cells.prod(); ++i) {
    const Tally& tally = tallies[static_cast<std::size_t>(i)];
    filled += tally.All() > 0 && tally.on + 0.5 * tally.front >= tally.behind ? 1 : 0;
  }
  return filled / cells.prod();
}

// Product over the four sides: 1 if nothing goes on in the plane beyond them, near 0 if a side is no edge.
double FreedomOf(const std::vector<Piercing>& piercings, const Outline& outline, const BeamSpacing& spacing,
                 double margin_m) {
  const Eigen::Vector2d axis = outline.Axis(), other(-axis.y(), axis.x());
  const Eigen::Vector2d half = outline.size_m / 2;
  const Eigen::Vector2d strip(std::max(0.3 * half.minCoeff(), 1.3 * spacing.Along_m(axis)),
                              std::max(0.3 * half.minCoeff(), 1.3 * spacing.Along_m(other)));
  std::array<Tally, 4> sides;
  double inside = 0;
  for (const Piercing& piercing : piercings) {
    const Eigen::Vector2d local = outline.Local(piercing.uv_m.cast<double>());
    const Eigen::Vector2d beyond = local.cwiseAbs() - half;
    if (beyond.maxCoeff() < 0) ++inside;
    for (const int k : {0, 1})
      if (beyond[k] > margin_m && beyond[k] < margin_m + strip[k] && beyond[1 - k] < 0)
        sides[static_cast<std::size_t>(2 * k + (local[k] > 0))].Add(piercing.evidence);
  }
  double freedom = 1;
  for (int i = 0; i < 4; ++i) {
    const Tally& side = sides[static_cast<std::size_t>(i)];
    const double expected = inside * strip[i / 2] / outline.size_m[i / 2];
    const double attached = (side.on + 0.5 * side.front) / std::max({side.All(), 0.5 * expected, 1.0});
    freedom *= 1 - std::min(1.0, 0.9 * attached);
  }
  return freedom;
}

}  // namespace

PlateSize PlateSizeOf(const Target& target) {
  if (target.plate_m) return {*target.plate_m, *target.plate_m};
  const Eigen::Vector2d pattern_m = PatternSize_m(target);
  return {pattern_m, pattern_m + Eigen::Vector2d::Constant(2 * target.square_m)};
}

Eigen::Vector2d Outline::Local(const Eigen::Vector2d& uv_m) const {
  const Eigen::Vector2d axis = Axis(), off = uv_m - centre_m;
  return {axis.dot(off), axis.x() * off.y() - axis.y() * off.x()};
}

double Outline::Depth_m(const Eigen::Vector2d& uv_m) const { return (size_m / 2 - Local(uv_m).cwiseAbs()).minCoeff(); }

Outline FindOutline(const std::vector<Piercing>& piercings, const PlateSize& size) {
  const Votes votes(piercings);
  const double short_m = size.Short_m();
  std::vector<Fit> fits = SearchTurned(votes, size, kTurns, {0.08 * short_m, 0.16 * short_m, 0.04 * short_m});
  std::stable_sort(fits.begin(), fits.end(), IsBetter);
  fits.resize(kTurnsKept);
  for (Fit& fit : fits)
    fit = Search(votes, size, fit.outline, 0.04 * short_m, CoordinatesOf(size), 0.08 * short_m, 0.01 * short_m);
  const auto best = std::min_element(fits.begin(), fits.end(), IsBetter);
  best->outline.angle_rad = Wrapped(best->outline.angle_rad);
  return best->outline;
}

Outline GuessOutline(const std::vector<Piercing>& piercings, const PlateSize& size) {
  const Votes votes(piercings);
  const double short_m = size.Short_m();
  const std::vector<Fit> fits =
      SearchTurned(votes, size, kTurnsGuessed, {0.1 * short_m, 0.3 * short_m, 0.07 * short_m});
  return std::min_element(fits.begin(), fits.end(), IsBetter)->outline;
}

double OverlapOf(const std::vector<Piercing>& piercings, const Outline& outline) {
  Tally inside, outside;
  for (const Piercing& piercing : piercings)
    (outline.Depth_m(piercing.uv_m.cast<double>()) > 0 ? inside : outside).Add(piercing.evidence);
  return inside.on / (inside.All() + outside.on + kFewRays);
}

Outline RefineOutline(const std::vector<Piercing>& piercings, const PlateSize& size, const Outline& start) {
  const double short_m = size.Short_m();
  Outline outline =
      Search(Votes(piercings), size, start, 0.025 * short_m, CoordinatesOf(size), 0.04 * short_m, 0.001 * short_m)
          .outline;
  outline.angle_rad = Wrapped(outline.angle_rad);
  return outline;
}

double EdgeMargin_m(const Outline& outline, const BeamSpacing& spacing) {
  const double step_m = std::min(spacing.across_m.norm(), spacing.along_m.norm());
  return std::min(0.15 * outline.size_m.minCoeff(), std::max(0.02, 0.75 * step_m));
}

double ScoreOf(const std::vector<Piercing>& piercings, const Outline& outline, const BeamSpacing& spacing) {
  const double margin_m = EdgeMargin_m(outline, spacing);
  Tally inside;
  for (const Piercing& piercing : piercings)
    if (outline.Depth_m(piercing.uv_m.cast<double>()) > margin_m) inside.Add(piercing.evidence);
  if (inside.on < 1) return 0;
  const double whole = inside.on / (inside.on + inside.behind + 0.5 * inside.front);
  return whole * whole * FillOf(piercings, outline, spacing) * FreedomOf(piercings, outline, spacing, margin_m) *
         (inside.on / (inside.on + 10));
}

}  // namespace rigcal::detect

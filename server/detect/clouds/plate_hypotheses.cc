#include "server/detect/clouds/plate_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

namespace rigcal::detect {
namespace {

constexpr std::size_t kSeedsMax = 12'000;
constexpr std::size_t kGuessesMax = 500;
constexpr std::size_t kBallBudget = 48, kConeBudget = 180, kGuessBudget = 160, kSpendBudget = 2000;
constexpr int kSeedRounds = 3;
constexpr double kSigmaMax_m = 0.06, kCosineMin = 0.15;

struct Scene {
  const CloudRays& rays;
  const PlateSize& size;
  double ball_m;
  std::vector<bool> spent;  // points of large planes: no seeds
};

std::uint64_t SeedCell(const Eigen::Vector3f& point_m, double side_m) {
  const Eigen::Vector3i cell = (point_m.cast<double>() / side_m).array().floor().cast<int>();
  std::uint64_t key = 0;
  for (const int axis : {0, 1, 2}) key = (key << 21) | static_cast<std::uint64_t>((cell[axis] + (1 << 20)) & 0x1FFFFF);
  return key;
}

std::optional<FittedPlane> PlaneAt(const Scene& scene, const Eigen::Vector3f& seed_m) {
  std::vector<std::uint32_t> indices;
  scene.rays.InBall(seed_m, kBallBudget, indices);
  std::vector<Eigen::Vector3d> points;
  points.reserve(indices.size());
  for (const std::uint32_t i : indices) points.push_back(scene.rays.points_m[i].cast<double>());
  auto plane = FitPlane(points, 0.12 * scene.ball_m, kSeedRounds);
  if (!plane || plane->sigma_m > std::min(kSigmaMax_m, 0.2 * scene.ball_m)) return std::nullopt;
  const Eigen::Vector3d seed = seed_m.cast<double>();
  if (-plane->normal.dot(seed) < kCosineMin * seed.norm()) return std::nullopt;
  if (std::abs(plane->Distance_m(seed)) > plane->Tolerance_m()) return std::nullopt;
  return plane;
}

// Rays about a point of the plane: within the plate's short side's circle; where no part of the plate can be.
struct Surroundings {
  double on_near = 0, behind_near = 0, on_far = 0, all_far = 0;
};

Surroundings Look(const std::vector<Piercing>& piercings, const Eigen::Vector2d& middle_m, double near_m,
                  double far_m) {
  Surroundings around;
  for (const Piercing& piercing : piercings) {
    const double distance_m = (piercing.uv_m.cast<double>() - middle_m).norm();
    if (distance_m < near_m) {
      around.on_near += piercing.evidence == Evidence::kOn;
      around.behind_near += piercing.evidence == Evidence::kBehind;
    } else if (distance_m > far_m) {
      around.on_far += piercing.evidence == Evidence::kOn;
      ++around.all_far;
    }
  }
  return around;
}

// Seeds no more on the large plane that goes through here.
void Spend(Scene& scene, const std::vector<Piercing>& piercings, double radius_m) {
  for (const Piercing& piercing : piercings)
    if (piercing.evidence == Evidence::kOn && piercing.uv_m.norm() < radius_m) scene.spent[piercing.ray] = true;
}

// Whether what is flat here may end within a plate's reach.
bool MayBePlate(Scene& scene, const FittedPlane& plane, const PlaneFrame& frame,
                const std::vector<Piercing>& piercings) {
  const double diagonal_m = scene.size.Diagonal_m();
  const Surroundings around = Look(piercings, Eigen::Vector2d::Zero(), scene.ball_m, diagonal_m);
  if (around.all_far > 8 && around.on_far > 0.5 * around.all_far) {
    if (around.on_far > 0.65 * around.all_far)
      Spend(scene, Pierce(scene.rays, plane, frame, 0.7 * diagonal_m, kSpendBudget), 0.7 * diagonal_m);
    return false;
  }
  return around.on_near >= 2 * around.behind_near;
}

// The surface's middle within reach, found by moving there.
Eigen::Vector2d MiddleOf(const std::vector<Piercing>& piercings, double reach_m) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (int round = 0; round < 5; ++round) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0;
    for (const Piercing& piercing : piercings)
      if (piercing.evidence == Evidence::kOn && (piercing.uv_m.cast<double>() - middle).norm() < reach_m)
        sum += piercing.uv_m.cast<double>(), ++count;
    if (count > 0) middle = sum / count;
  }
  return middle;
}

std::optional<PlateHypothesis> HypothesisAt(Scene& scene, const Eigen::Vector3f& seed_m) {
  const auto plane = PlaneAt(scene, seed_m);
  if (!plane) return std::nullopt;
  const PlaneFrame frame = FrameOn(*plane, seed_m.cast<double>());
  const double diagonal_m = scene.size.Diagonal_m();
  const auto piercings = Pierce(scene.rays, *plane, frame, 1.6 * diagonal_m, kConeBudget);
  if (!MayBePlate(scene, *plane, frame, piercings)) return std::nullopt;
  const Eigen::Vector2d middle = MiddleOf(piercings, 0.45 * diagonal_m);
  const Surroundings around = Look(piercings, middle, 0.4 * diagonal_m, 0.6 * diagonal_m);
  PlateHypothesis hypothesis{*plane, frame.At(middle), 0};
  hypothesis.promise =
      around.on_near / (around.on_near + around.behind_near + 3) - around.on_far / (around.all_far + 3);
  return hypothesis;
}

// Without those that lie `apart_m` or nearer to a more promising one and face the same way.
std::vector<PlateHypothesis> Distinct(const std::vector<PlateHypothesis>& all, double apart_m, std::size_t most) {
  std::vector<PlateHypothesis> kept;
  for (const PlateHypothesis& hypothesis : all) {
    if (kept.size() >= most) break;
    const auto same = [&](const PlateHypothesis& other) {
      return (hypothesis.middle_m - other.middle_m).norm() < apart_m &&
             hypothesis.plane.normal.dot(other.plane.normal) > 0.94;
    };
    if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(hypothesis);
  }
  return kept;
}

// The plane through what lies on the old one within reach of the middle.
void Refit(const CloudRays& rays, const PlateSize& size, PlateHypothesis& hypothesis) {
  const PlaneFrame frame = FrameOn(hypothesis.plane, hypothesis.middle_m);
  std::vector<Eigen::Vector3d> points;
  for (const Piercing& piercing : Pierce(rays, hypothesis.plane, frame, 0.7 * size.Short_m(), kGuessBudget))
    if (piercing.evidence == Evidence::kOn) points.push_back(rays.points_m[piercing.ray].cast<double>());
  if (const auto plane = FitPlane(points, 0.06 * size.Short_m(), kSeedRounds)) hypothesis.plane = *plane;
}

// Lays an outline roughly over the place: a better middle, and its overlap as the promise.
void Guess(const CloudRays& rays, const PlateSize& size, PlateHypothesis& hypothesis) {
  Refit(rays, size, hypothesis);
  const PlaneFrame frame = FrameOn(hypothesis.plane, hypothesis.middle_m);
  const auto piercings = Pierce(rays, hypothesis.plane, frame, 0.95 * size.max_m.norm(), kGuessBudget);
  const Outline outline = GuessOutline(piercings, size);
  hypothesis.promise = OverlapOf(piercings, outline);
  hypothesis.middle_m = frame.At(outline.centre_m);
}

void SortByPromise(std::vector<PlateHypothesis>& hypotheses) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const PlateHypothesis& a, const PlateHypothesis& b) { return a.promise > b.promise; });
}

}  // namespace

std::vector<PlateHypothesis> PlateHypotheses(const CloudRays& rays, const PlateSize& size) {
  Scene scene{rays, size, size.Short_m() / 2, std::vector<bool>(rays.points_m.size(), false)};
  std::vector<PlateHypothesis> all;
  std::unordered_set<std::uint64_t> seen;
  const double side_m = std::max(0.38 * size.Short_m(), CloudRays::kRangeMax_m / 1e6);
  for (std::size_t i = 0; i < rays.points_m.size() && seen.size() < kSeedsMax; ++i) {
    if (scene.spent[i] || !seen.insert(SeedCell(rays.points_m[i], side_m)).second) continue;
    if (auto hypothesis = HypothesisAt(scene, rays.points_m[i])) all.push_back(*hypothesis);
  }
  SortByPromise(all);
  std::vector<PlateHypothesis> guesses = Distinct(all, 0.15 * size.Short_m(), kGuessesMax);
  for (PlateHypothesis& hypothesis : guesses) Guess(rays, size, hypothesis);
  SortByPromise(guesses);
  return Distinct(guesses, 0.3 * size.Short_m(), kHypothesesMax);
}

}  // namespace rigcal::detect

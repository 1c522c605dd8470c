#include "server/calib/lidar_lidar/lidar_lidar_beams.h"

#include <cmath>

#include "server/base/parallel_for.h"
#include "server/calib/core/beam_groups.h"

namespace rigcal::calib {
namespace {

// Causes: the groups of the map's lidar, then those of the moving one.
constexpr std::size_t kCauses = 2 * kBeamGroups;

// A voxel's mean moves by the share of it that the group's points are.
void AddPoint(const Eigen::Vector3f& p_m, double count, std::vector<NdtMove>& moves) {
  const std::size_t group = BeamGroupOf(p_m);
  const Eigen::Vector3d share = p_m.cast<double>().normalized() / count;
  for (NdtMove& move : moves)
    if (move.cause == group) {
      move.by_m += share;
      return;
    }
  moves.push_back({group, share});
}

std::vector<std::vector<NdtMove>> MovesOfVoxels(const NdtMap& map, const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<std::vector<NdtMove>> moves(map.voxels.size());
  for (const Eigen::Vector3f& p : points_m) {
    const Eigen::Vector3d scaled = p.cast<double>() / map.voxel_m;
    if (!(scaled.cwiseAbs().maxCoeff() < kCellsMax - 4)) continue;
    const Eigen::Vector3i at = scaled.array().floor().cast<int>();
    const int number = map.index.Find(CellKeyOf(at.x(), at.y(), at.z()));
    if (number < 0) continue;
    const auto voxel = static_cast<std::size_t>(number);
    AddPoint(p, map.voxels[voxel].count, moves[voxel]);
  }
  return moves;
}

// A cell is a quarter of a voxel wide: it counts as of one group.
std::vector<std::vector<NdtMove>> MovesOfPoints(const std::vector<NdtPoint>& points) {
  std::vector<std::vector<NdtMove>> moves;
  moves.reserve(points.size());
  for (const NdtPoint& point : points)
    moves.push_back({{kBeamGroups + BeamGroupOf(point.p_m.cast<float>()), point.p_m.normalized()}});
  return moves;
}

struct Sums {
  Matrix6d H = Matrix6d::Zero();
  Directions gradients = Directions::Zero(6, kCauses);
};

Sums SumsOfCapture(const LidarLidarProblem& problem, const LidarLidarWork& work, std::size_t k, const Se3& T) {
  const LidarLidarCapture& capture = problem.captures[work.used[k]];
  const LidarClouds& clouds = work.clouds[k];
  const NdtTerm term{&clouds.surfaces, &clouds.points.back()};
  const NdtMoves moves{MovesOfPoints(clouds.points.back()),
                       MovesOfVoxels(clouds.surfaces, work.a_is_map ? capture.a_m : capture.b_m)};
  return {ScoreOf({term}, T).information, GradientByMoves(term, moves, kCauses, T)};
}

}  // namespace

BeamShifts ShiftsByBeams(const LidarLidarProblem& problem, const LidarLidarWork& work, const Se3& T_map_moving,
                         const Directions& unknown) {
  std::vector<Sums> captures(work.clouds.size());
  ParallelFor(captures.size(), [&](std::size_t k) { captures[k] = SumsOfCapture(problem, work, k, T_map_moving); });
  Sums all;
  for (const Sums& one : captures) all.H += one.H, all.gradients += one.gradients;
  const Directions steps = StepsTo(all.H, all.gradients, unknown);
  return {steps.leftCols(kBeamGroups), steps.rightCols(kBeamGroups)};
}

}  // namespace rigcal::calib

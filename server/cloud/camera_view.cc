#include "server/cloud/camera_view.h"

#include <algorithm>
#include <cmath>

#include "server/base/process/parallel_for.h"
#include "server/cloud/depth_buffer.h"
#include "server/cloud/lens.h"

namespace rigcal::cloud {
namespace {

constexpr float kCellMin_px = 1, kCellMax_px = 16;
constexpr float kCells = 1.5e6F;        // of a buffer, at most about
constexpr float kPatchCellsMax = 1024;  // that one beam covers: a bound on work, beyond any lidar's spacing
constexpr float kPatchHalfMax = 48;     // cells
constexpr std::size_t kAhead = 12;      // candidates
constexpr int kBands = 8;               // of rows, one thread each
constexpr float kHidden_m = 0.03F, kHiddenPerRange = 0.005F, kHiddenPerSpacing = 0.5F;
constexpr float kBorderShare = 0.08F;  // of the shorter side, in which the weight falls
constexpr float kBorderLeast = 0.01F, kAngleLeast = 0.05F;

// A point inside the picture, before it is known whether it is hidden.
struct Candidate {
  std::uint32_t point_idx;
  Patch patch;
  float depth_m;  // of the surface between this beam and its neighbours
  float weight;
};
using Candidates = std::vector<std::vector<Candidate>>;

struct Camera {
  Lens lens;
  Eigen::Matrix3f R_cam_lidar;
  Eigen::Vector3f p_cam_lidar_m;
  float width_px, height_px, cell_px;
};

float CellOf(const Lens& lens, const Beams& beams, const Picture& picture) {
  const float finer_rad = std::min(beams.azimuth_step_rad, beams.elevation_step_rad);
  const float area_px2 = static_cast<float>(picture.width_px) * static_cast<float>(picture.height_px);
  const float least_px = std::max(kCellMin_px, std::sqrt(area_px2 / kCells));
  return std::max(least_px, std::min(kCellMax_px, 0.5F * lens.focal_px() * finer_rad));
}

Camera CameraOf(const Beams& beams, const CloudCamera& camera, const Picture& picture) {
  Camera ready{Lens(camera.intrinsics, picture.width_px, picture.height_px),
               camera.T_cam_lidar.R().cast<float>(),
               camera.T_cam_lidar.p_m.cast<float>(),
               static_cast<float>(picture.width_px),
               static_cast<float>(picture.height_px),
               1};
  ready.cell_px = CellOf(ready.lens, beams, picture);
  return ready;
}

bool Inside(const Camera& camera, const Eigen::Vector2f& uv_px) {
  return uv_px.x() >= 0 && uv_px.y() >= 0 && uv_px.x() <= camera.width_px - 1 && uv_px.y() <= camera.height_px - 1;
}

// How far the picture moves when the point moves by a patch's half side; a lens that does not see that far: one cell.
Eigen::Vector2f Extent(const Camera& camera, const Eigen::Vector3f& p_cam, const Eigen::Vector3f& half_side,
                       const Eigen::Vector2f& uv_px) {
  Eigen::Vector2f moved_px;
  if (!camera.lens.Project(p_cam + camera.R_cam_lidar * half_side, moved_px)) return {0, 0};
  return (moved_px - uv_px).cwiseAbs() / camera.cell_px;
}

void SetSize(const Camera& camera, const Beams& beams, const Eigen::Vector3f& point, const Eigen::Vector3f& p_cam,
             const Eigen::Vector2f& uv_px, Candidate& candidate) {
  Eigen::Vector3f level, upright;
  beams.PatchOf(point, level, upright);
  Eigen::Vector2f half = Extent(camera, p_cam, level, uv_px) + Extent(camera, p_cam, upright, uv_px);
  candidate.depth_m = 2 * (std::abs(level.dot(point)) + std::abs(upright.dot(point))) / std::max(point.norm(), 1e-6F);
  half = half.cwiseMin(kPatchHalfMax);
  const float cells = 4 * half.x() * half.y();
  if (cells > kPatchCellsMax) half *= std::sqrt(kPatchCellsMax / cells);
  candidate.patch.half_x = half.x(), candidate.patch.half_y = half.y();
}

float WeightOf(const Camera& camera, const Eigen::Vector3f& point, const Eigen::Vector3f& p_cam, float range_m,
               const Eigen::Vector2f& uv_px) {
  const float from_axis = std::max(p_cam.z() / range_m, kAngleLeast);
  const float between = p_cam.dot(camera.R_cam_lidar * point) / (range_m * std::max(point.norm(), 1e-6F));
  const float apart = std::max(between, kAngleLeast);
  return from_axis * from_axis * apart * apart *
         BorderWeight(uv_px.x(), uv_px.y(), static_cast<int>(camera.width_px), static_cast<int>(camera.height_px));
}

Eigen::Vector3f InCamera(const Camera& camera, const Eigen::Vector3f& point) {
  return camera.R_cam_lidar * point + camera.p_cam_lidar_m;
}

// Points that may be in the picture. Nothing is decided in the loop: guessing wrong would cost more than the
// arithmetic.
std::vector<std::uint32_t> NearlyInside(const Camera& camera, const Beams& beams, std::size_t part) {
  const std::size_t first = part * CameraView::kPart;
  const std::size_t end = std::min(beams.points_m.size(), first + CameraView::kPart);
  std::vector<std::uint32_t> inside(end - first + 1);
  std::size_t count = 0;
  for (std::size_t i = first; i < end; ++i) {
    inside[count] = static_cast<std::uint32_t>(i);
    count += camera.lens.MayProject(InCamera(camera, beams.points_m[i])) ? 1 : 0;
  }
  inside.resize(count);
  return inside;
}

void ProjectPart(const Camera& camera, const Beams& beams, std::size_t part, std::vector<Candidate>& found) {
  const std::vector<std::uint32_t> nearly = NearlyInside(camera, beams, part);
  found.reserve(nearly.size());
  for (const std::uint32_t i : nearly) {
    const Eigen::Vector3f& point = beams.points_m[i];
    const Eigen::Vector3f p_cam = InCamera(camera, point);
    Eigen::Vector2f uv_px;
    if (!camera.lens.Project(p_cam, uv_px) || !Inside(camera, uv_px)) continue;
    Candidate candidate;
    candidate.point_idx = i;
    candidate.patch.x = (uv_px.x() + 0.5F) / camera.cell_px, candidate.patch.y = (uv_px.y() + 0.5F) / camera.cell_px;
    candidate.patch.range_m = p_cam.norm();
    SetSize(camera, beams, point, p_cam, uv_px, candidate);
    candidate.weight = WeightOf(camera, point, p_cam, candidate.patch.range_m, uv_px);
    found.push_back(candidate);
  }
}

// Threads share the rows, and every cell keeps its nearest: the order of the points does not show.
DepthBuffer Splatted(const Camera& camera, const Candidates& candidates) {
  DepthBuffer buffer(static_cast<int>(camera.width_px / camera.cell_px) + 1,
                     static_cast<int>(camera.height_px / camera.cell_px) + 1);
  ParallelFor(kBands, [&](std::size_t band) {
    const int height = buffer.height();
    const int first = static_cast<int>(band) * height / kBands, last = (static_cast<int>(band) + 1) * height / kBands;
    for (const auto& part : candidates)
      for (const Candidate& candidate : part) {
        const Patch& patch = candidate.patch;
        const bool away = patch.y + patch.half_y + 1 < static_cast<float>(first) ||
                          patch.y - patch.half_y - 1 > static_cast<float>(last);
        if (!away) buffer.Splat(patch, first, last);
      }
  });
  return buffer;
}

std::size_t OffsetOf(const Picture& picture, int x, int y) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) + static_cast<std::size_t>(x));
}

// Where a candidate's pixel is.
Eigen::Vector2f PixelOf(const Camera& camera, const Patch& patch) {
  return {std::clamp(patch.x * camera.cell_px - 0.5F, 0.0F, camera.width_px - 1),
          std::clamp(patch.y * camera.cell_px - 0.5F, 0.0F, camera.height_px - 1)};
}

// The order of a scan is not the order of a picture: most of the time would go into waiting for memory.
void FetchAhead(const Camera& camera, const DepthBuffer& buffer, const Picture& picture, const Patch& patch) {
  const Eigen::Vector2f uv_px = PixelOf(camera, patch);
  const int x = static_cast<int>(uv_px.x()), y = static_cast<int>(uv_px.y());
  __builtin_prefetch(&buffer.NearestAt(patch.x, patch.y));
  __builtin_prefetch(&picture.rgb[OffsetOf(picture, x, y)]);
  __builtin_prefetch(&picture.rgb[OffsetOf(picture, x, std::min(y + 1, picture.height_px - 1))]);
}

Rgb Between(const Picture& picture, float u, float v) {
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
  const int right = x0 + 1 < picture.width_px ? 3 : 0;
  const std::size_t row = 3 * static_cast<std::size_t>(picture.width_px);
  const std::uint8_t* top = &picture.rgb[OffsetOf(picture, x0, y0)];
  const std::uint8_t* low = y0 + 1 < picture.height_px ? top + row : top;
  const float fx = u - static_cast<float>(x0), fy = v - static_cast<float>(y0);
  Rgb rgb;
  for (int c = 0; c < 3; ++c) {
    const float above = static_cast<float>(top[c]) * (1 - fx) + static_cast<float>(top[c + right]) * fx;
    const float below = static_cast<float>(low[c]) * (1 - fx) + static_cast<float>(low[c + right]) * fx;
    rgb[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(above * (1 - fy) + below * fy + 0.5F);
  }
  return rgb;
}

std::vector<SeenPoint> NotHidden(const Camera& camera, const Beams& beams, const DepthBuffer& buffer,
                                 const std::vector<Candidate>& candidates, const Picture& picture) {
  std::vector<SeenPoint> seen;
  seen.reserve(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& candidate = candidates[i];
    const Patch& patch = candidate.patch;
    if (i + kAhead < candidates.size()) FetchAhead(camera, buffer, picture, candidates[i + kAhead].patch);
    const float slack_m = kHidden_m + kHiddenPerRange * patch.range_m + candidate.depth_m +
                          kHiddenPerSpacing * beams.SpacingAt_m(beams.points_m[candidate.point_idx]);
    if (patch.range_m > buffer.NearestAt(patch.x, patch.y) + slack_m) continue;
    const Eigen::Vector2f uv_px = PixelOf(camera, patch);
    seen.push_back({candidate.point_idx, uv_px.x(), uv_px.y(), patch.range_m, candidate.weight,
                    Between(picture, uv_px.x(), uv_px.y())});
  }
  return seen;
}

}  // namespace

float BorderWeight(float u_px, float v_px, int width_px, int height_px) {
  const auto width = static_cast<float>(width_px), height = static_cast<float>(height_px);
  const float inside_px = std::min({u_px + 0.5F, v_px + 0.5F, width - 0.5F - u_px, height - 0.5F - v_px});
  const float share = std::clamp(inside_px / (kBorderShare * std::min(width, height)), 0.0F, 1.0F);
  return std::max(kBorderLeast, share * share * (3 - 2 * share));
}

CameraView See(const Beams& beams, const CloudCamera& camera, const Picture& picture) {
  CameraView view;
  view.parts.resize((beams.points_m.size() + CameraView::kPart - 1) / CameraView::kPart);
  if (picture.width_px < 2 || picture.height_px < 2) return view;
  const Camera ready = CameraOf(beams, camera, picture);
  Candidates candidates(view.parts.size());
  ParallelFor(candidates.size(), [&](std::size_t part) { ProjectPart(ready, beams, part, candidates[part]); });
  const DepthBuffer buffer = Splatted(ready, candidates);
  ParallelFor(candidates.size(),
              [&](std::size_t part) { view.parts[part] = NotHidden(ready, beams, buffer, candidates[part], picture); });
  return view;
}

}  // namespace rigcal::cloud

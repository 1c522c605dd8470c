// What the finished edges of all methods share.
#pragma once

#include <string>
#include <vector>

#include "server/base/out_of_memory.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/motion/motion_observability.h"
#include "server/model/camera.h"
#include "server/model/method.h"

namespace rigcal::calib {

// Of a pair that is not solved yet.
[[nodiscard]] Edge UnsolvedEdge(const SensorId& a, const SensorId& b, Method method, std::size_t captures);
// Failed; a board that is described wrong is said before everything that follows from it.
[[nodiscard]] Edge FailedFor(std::vector<Diagnosis> diagnoses, Edge edge);
[[nodiscard]] Edge Good(const Se3& T_a_b, Uncertainty uncertainty, std::vector<Diagnosis> notes, Edge edge);

void Append(std::vector<Diagnosis> more, std::vector<Diagnosis>& diagnoses);
// "fx_a_px", ..., "k1_a_ratio" with `camera` "_a".
void AddIntrinsicsFigures(const CameraIntrinsics& intrinsics, const std::string& camera, Edge& edge);
// Of a line that is not told, frame a.
void AddAxisFigures(const Eigen::Vector3d& axis_a, Edge& edge);
void AddMotionFigures(const MotionReach& motion, Edge& edge);

// `estimate()`; what a library throws becomes `failed(error)`. Throws where there is no memory, which is not the data's
// fault: the caller tries again.
template <typename Estimate, typename Failed>
Edge Guarded(const Estimate& estimate, const Failed& failed) {
  try {
    return estimate();
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;
    return failed(Error{ErrorCode::kInternal, exception.what(), "Report this with the session's id."});
  }
}

}  // namespace rigcal::calib

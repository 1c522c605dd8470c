// How uncertain a camera's projections are, for reports: the map that mrcal draws of a camera.
#pragma once

#include <optional>

#include "server/model/camera_fit.h"
#include "server/model/projection_map.h"

namespace rigcal::calib {

// For the point p that the camera has at a pixel q, at a given distance from it, to first order in the error db of the
// intrinsics b (covariance C = fit.covariance):
//   q + dq = pi(b + db, Exp(K db) p),   dq = P db,   P = J_b + J_p [I, -[p]x] K,   Var(q) = P C P^T,
// J_b and J_p the derivatives of the projection pi by intrinsics and point, K = fit.implied_motion. Told is the square
// root of the larger eigenvalue of Var(q). Of a very far point only the turn in K is left: P = J_b - J_p [v]x K_turn,
// v the ray. K db is the motion (turn and shift) of the boards in the camera's frame that best explains db: an error of
// the intrinsics that a small motion of the camera makes good at all corners does not count, for whoever uses the lens
// uses it with the pose that the same corners gave.
// Source: mrcal (Kogan), "Projection uncertainty" and "Projection uncertainty: cross-reprojection"; its measure
// "worstdirection-stdev". K: gathered_views.h.
//
// Nothing where the fit has no covariance, or no picture size.
[[nodiscard]] std::optional<ProjectionUncertainty> UncertaintyOfProjections(const CameraFit& fit);

}  // namespace rigcal::calib

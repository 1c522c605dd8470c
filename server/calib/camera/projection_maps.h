// What reports draw over a camera's picture: how its lens differs between two revisions, how uncertain projections are.
#pragma once

#include <optional>

#include "server/model/sensors/camera_fit.h"
#include "server/model/sensors/projection_map.h"

namespace rigcal::calib {

// Of the far point with the ray v = pi^-1(b0, q) of a pixel q, with b0 the intrinsics before and b1 those now:
//   shift(q) = pi(b1, R v) - q,   R = argmin sum_i w_i |pi(b1, R v_i) - q_i|^2.
// The rotation R is the one between the two cameras that the intrinsics imply (of one and the same camera: where a
// lens points is a matter of its pose); it is found over the middles of the fields, from the identity by Gauss and
// Newton, with w = n0 n1 / (n0 + n1) of the corners n0 and n1 that the two saw there (all alike where they saw no field
// both). Source: mrcal (Kogan), "Model differencing", for points at infinity.
//
// Nothing where one of both has no intrinsics, or the pictures are of different size.
[[nodiscard]] std::optional<LensChange> ChangeOfLens(const CameraFit& before, const CameraFit& now);

// How uncertain a camera's projections are: the map that mrcal draws of a camera.
//
// For the point p that the camera has at a pixel q, at a given distance from it, to first order in the error db of the
// intrinsics b (covariance C = fit.covariance):
//   q + dq = pi(b + db, Exp(K db) p),   dq = P db,   P = J_b + J_p [I, -[p]x] K,   Var(q) = P C P^T,
// J_b and J_p the derivatives of the projection pi by intrinsics and point, K = fit.implied_motion. Told is the square
// root of the larger eigenvalue of Var(q). Of a very far point only the turn in K is left: P = J_b - J_p [v]x K_turn,
// v the ray. K db is the motion (turn and shift) of the boards in the camera's frame that best explains db: an error of
// the intrinsics that a small motion of the camera makes good at all corners does not count, for whoever uses the lens
// uses it with the pose that the same corners gave.
// Source: mrcal (Kogan), "Projection uncertainty" and "Projection uncertainty: cross-reprojection"; its measure
// "worstdirection-stdev". K: view_moments.h.
//
// Nothing where the fit has no covariance, or no picture size.
[[nodiscard]] std::optional<ProjectionUncertainty> UncertaintyOfProjections(const CameraFit& fit);

}  // namespace rigcal::calib

// An edge: a pairwise result T_a_b with its uncertainty, or the diagnosis of why there is none.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/diagnosis.h"
#include "server/model/edges/uncertainty.h"

namespace rigcal {

enum class EdgeState { kGood, kFailed };  // "good" | "failed"

// What shows how the edge was made, content-addressed: a picture of one capture (JPEG or PNG), or what all captures say
// of a camera (formats/edges/camera_fit.h).
struct Evidence {
  std::string title;  // "front_left / 003: 54 corners"
  SensorId sensor;
  CaptureId capture;   // empty: of all
  Digest digest;       // of its bytes in the blob store
  std::string suffix;  // "jpg" | "png" | "fit"
};

// What one capture said: rms of its residuals, in ResidualUnitOf() the edge's method.
struct CaptureResidual {
  CaptureId capture;
  double rms = 0.0;
  bool used = true;
  std::string note;  // why it was not used
};

// How a note begins of a capture that a pair of a very large session left out.
inline constexpr std::string_view kLeftToRefinement = "left to the joint refinement";

struct Edge {
  EdgeId id;
  RobotId robot;
  SensorId frame_a;
  SensorId frame_b;
  Se3 T_a_b;                // meaningful only if state is kGood
  Uncertainty uncertainty;  // likewise
  std::string method;       // "stereo", "given", ...
  SessionId session;        // empty: pushed as a finished edge
  std::optional<Stamp> measured_at =
      {};  // of a pushed one, as it was told; absent: it was not, or its session tells it
  int epoch = 1;
  EdgeState state = EdgeState::kFailed;
  std::vector<Diagnosis> diagnoses;       // why it failed, or what a reader should know about a good edge
  std::map<std::string, double> figures;  // the method's own checks, unit last: "rms_px", "captures", ...
  std::vector<CaptureResidual> captures;
  std::vector<Evidence> evidence;
};

// "px" (reprojection error), or "m": distance of the points from the board (lidar_camera, tracker_lidar) or of held-out
// points from the other lidar's surfaces (lidar_lidar), or of where the two sensors of a moving body put it
// (non_overlapping, tracker_camera, pose_streams).
[[nodiscard]] std::string ResidualUnitOf(const std::string& method);

// id = sha256 over robot, source digest and index (design, words). For an estimated edge the source is its session and
// the index its method and pair; for a pushed one the source is the digest of its canonical content and the index
// counts equal edges of a batch, so that the order of a file does not matter.
[[nodiscard]] EdgeId EstimatedEdgeId(const RobotId& robot, const SessionId& session, const std::string& method,
                                     const SensorId& frame_a, const SensorId& frame_b);
// Of what is estimated again from the same session, the first time having failed as the edge `earlier`.
[[nodiscard]] EdgeId RepeatedEdgeId(const EdgeId& earlier);
[[nodiscard]] EdgeId PushedEdgeId(const RobotId& robot, const Digest& content, std::uint64_t occurrence_idx);
// Digest of frames, pose, information, method and, where it is told, when it was measured; bit by bit.
[[nodiscard]] Digest ContentDigest(const Edge& edge);
// Sets ids of finished edges that were read from a file: content digest + occurrence index.
void AssignPushedIds(std::vector<Edge>& edges);
// sha256 over the sorted ids: the same edges in any order are the same batch.
[[nodiscard]] BatchId BatchIdOf(const RobotId& robot, const std::vector<Edge>& edges);

// Unit quaternion to 1e-6, finite, frames differ, uncertainty valid, rank >= 1. The error names edge and field.
[[nodiscard]] Status Validate(const Edge& edge);

}  // namespace rigcal

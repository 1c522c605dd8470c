// What the finished edges of all methods share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/process/out_of_memory.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/motion/motion_observability.h"
#include "server/model/edges/edge.h"
#include "server/model/edges/method.h"
#include "server/model/sensors/camera.h"
#include "server/model/sensors/pose_table.h"

namespace rigcal::calib {

// Of a pair that is not solved yet.
[[nodiscard]] Edge UnsolvedEdge(const SensorId& a, const SensorId& b, Method method, std::size_t captures);
// Failed; a board that is described wrong is said before everything that follows from it. Figures of the diagnoses are
// the edge's from then on.
[[nodiscard]] Edge FailedFor(std::vector<Diagnosis> diagnoses, Edge edge);
[[nodiscard]] Edge Good(const Se3& T_a_b, Uncertainty uncertainty, std::vector<Diagnosis> notes, Edge edge);

// What the files of one sensor of a pair hold, capture by capture: pictures, clouds or rows of poses.
struct FilesFound {
  std::size_t files = 0, unreadable = 0, with_board = 0;  // of a tracker every row counts as one with a board
  std::optional<std::size_t> first_unreadable_idx;        // into the captures of the pair
  // A file; of those that are not `readable` the first is remembered, by its capture.
  void Add(std::size_t capture_idx, bool readable, bool board);
};
// "files_a" and "files_with_board_a" with `side` "_a"; where there are any, "files_unreadable_a" and
// "first_unreadable_a_idx". On a good edge only where captures lack a file of this sensor.
void AddFilesFound(const FilesFound& found, const std::string& side, Edge& edge);
// Of a tracker's positions that look like millimetres (unit_doubt.h), with "positions_step_a_m" with `side` "_a" among
// its figures; nothing where they look like metres.
[[nodiscard]] std::optional<Diagnosis> PositionsInMillimetres(const SensorId& tracker, const PoseTable& poses,
                                                              const std::string& side);

// Behind those that are there, in their order.
void Append(std::vector<Diagnosis> more, std::vector<Diagnosis>& diagnoses);
// "fx_a_px", ..., "k1_a_ratio" with `camera` "_a".
void AddIntrinsicsFigures(const CameraIntrinsics& intrinsics, const std::string& camera, Edge& edge);
// Of a line that is not told, frame a.
void AddAxisFigures(const Eigen::Vector3d& axis_a, Edge& edge);
void AddMotionFigures(const MotionReach& motion, Edge& edge);

// Tells each of the pair's own captures that was left out, with the reason.
void AddLeftOut(const PairCaptures& chosen, const std::set<CaptureId>& of_pair, Edge& edge);
// The edge says in which captures both sensors have one and the same file ("same_picture": SamePictures() of
// session.h), and lists these as not used; figures that tell places in the list ("first_unreadable_a_idx") go on naming
// the same captures. Nothing if `same` is empty.
void TellSamePictures(const std::vector<CaptureId>& same, Edge& edge);

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

// Guarded: the edge of the captures chosen; where that is none, or leaves a direction open, the edge of all.
// `drop(problem, left_out)` takes captures out of a problem; `of_pair` are those that it has files of.
template <typename Problem, typename Drop, typename Estimate, typename Failed>
Edge EdgeOfChosen(const Problem& problem, const std::set<CaptureId>& of_pair, const std::set<CaptureId>& seen_by_both,
                  const Drop& drop, const Estimate& estimate, const Failed& failed) {
  const auto of_chosen = [&] {
    const PairCaptures chosen = ChooseCaptures(problem.session_captures, seen_by_both);
    if (chosen.left_out.empty()) return estimate(problem);
    Problem fewer = problem;
    drop(fewer, chosen.left_out);
    Edge edge = estimate(fewer);
    if (edge.state != EdgeState::kGood || edge.uncertainty.rank < 6) return estimate(problem);
    AddLeftOut(chosen, of_pair, edge);
    return edge;
  };
  return Guarded(of_chosen, failed);
}

}  // namespace rigcal::calib

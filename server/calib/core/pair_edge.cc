#include "server/calib/core/pair_edge.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/core/wording.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::calib {
namespace {

// In the order of the list's captures.
void AddUnused(const std::vector<CaptureId>& captures, const std::string& why, Edge& edge) {
  for (const CaptureId& capture : captures) edge.captures.push_back({capture, 0.0, false, why});
  std::stable_sort(edge.captures.begin(), edge.captures.end(),
                   [](const CaptureResidual& a, const CaptureResidual& b) { return a.capture < b.capture; });
}

}  // namespace

Edge UnsolvedEdge(const SensorId& a, const SensorId& b, Method method, std::size_t captures) {
  Edge edge;
  edge.frame_a = a;
  edge.frame_b = b;
  edge.method = NameOf(method);
  edge.figures["captures_total"] = static_cast<double>(captures);
  return edge;
}

Edge FailedFor(std::vector<Diagnosis> diagnoses, Edge edge) {
  PutLayoutFirst(diagnoses);
  edge.state = EdgeState::kFailed;
  edge.diagnoses = std::move(diagnoses);
  for (Diagnosis& diagnosis : edge.diagnoses) edge.figures.merge(std::exchange(diagnosis.figures, {}));
  return edge;
}

Edge Good(const Se3& T_a_b, Uncertainty uncertainty, std::vector<Diagnosis> notes, Edge edge) {
  edge.state = EdgeState::kGood;
  edge.T_a_b = T_a_b;
  edge.uncertainty = std::move(uncertainty);
  edge.diagnoses = std::move(notes);
  return edge;
}

void FilesFound::Add(std::size_t capture_idx, bool readable, bool board) {
  ++files;
  with_board += board ? 1 : 0;
  if (readable) return;
  ++unreadable;
  if (!first_unreadable_idx) first_unreadable_idx = capture_idx;
}

void AddFilesFound(const FilesFound& found, const std::string& side, Edge& edge) {
  const auto captures = edge.figures.find("captures_total");
  const bool complete = captures != edge.figures.end() && static_cast<double>(found.files) >= captures->second;
  if (edge.state == EdgeState::kGood && complete) return;
  edge.figures["files" + side] = static_cast<double>(found.files);
  edge.figures["files_with_board" + side] = static_cast<double>(found.with_board);
  if (!found.first_unreadable_idx) return;
  edge.figures["files_unreadable" + side] = static_cast<double>(found.unreadable);
  edge.figures["first_unreadable" + side + "_idx"] = static_cast<double>(*found.first_unreadable_idx);
}

std::optional<Diagnosis> PositionsInMillimetres(const SensorId& tracker, const PoseTable& poses,
                                                const std::string& side) {
  const std::string doubt = UnitDoubt(poses);
  if (doubt.empty()) return std::nullopt;
  return Diagnosis{"positions_in_millimetres",
                   tracker.str() + ": " + doubt,
                   "Give the positions in " + tracker.str() + "/poses.csv in metres.",
                   {{"positions_step" + side + "_m", LongestStep_m(poses)}}};
}

void Append(std::vector<Diagnosis> more, std::vector<Diagnosis>& diagnoses) {
  for (Diagnosis& diagnosis : more) diagnoses.push_back(std::move(diagnosis));
}

void AddIntrinsicsFigures(const CameraIntrinsics& intrinsics, const std::string& camera, Edge& edge) {
  edge.figures["fx" + camera + "_px"] = intrinsics.fx_px;
  edge.figures["fy" + camera + "_px"] = intrinsics.fy_px;
  edge.figures["cx" + camera + "_px"] = intrinsics.cx_px;
  edge.figures["cy" + camera + "_px"] = intrinsics.cy_px;
  const std::vector<std::string>& names = DistortionNames(intrinsics.model);
  for (std::size_t i = 0; i < names.size(); ++i) edge.figures[names[i] + camera + "_ratio"] = intrinsics.distortion[i];
}

void AddAxisFigures(const Eigen::Vector3d& axis_a, Edge& edge) {
  edge.figures["axis_a_x_ratio"] = axis_a.x();
  edge.figures["axis_a_y_ratio"] = axis_a.y();
  edge.figures["axis_a_z_ratio"] = axis_a.z();
}

void AddMotionFigures(const MotionReach& motion, Edge& edge) {
  edge.figures["tilt_rad"] = motion.tilt_rad;
  edge.figures["tilt_noise_rad"] = motion.tilt_noise_rad;
  edge.figures["turn_rad"] = motion.turn_rad;
}

void AddLeftOut(const PairCaptures& chosen, const std::set<CaptureId>& of_pair, Edge& edge) {
  std::vector<CaptureId> left_out;
  std::set_intersection(chosen.left_out.begin(), chosen.left_out.end(), of_pair.begin(), of_pair.end(),
                        std::back_inserter(left_out));
  AddUnused(left_out,
            Worded("{}: the pair uses {} of its {} captures, spread over the session",
                   {std::string(kLeftToRefinement), of_pair.size() - left_out.size(), of_pair.size()}),
            edge);
  edge.figures["captures_total"] = static_cast<double>(of_pair.size());
}

void TellSamePictures(const std::vector<CaptureId>& same, Edge& edge) {
  if (same.empty()) return;
  edge.diagnoses.insert(edge.diagnoses.begin(),
                        {"same_picture",
                         Worded("{} and {} have one and the same file in these captures, which are not used: {}.",
                                {edge.frame_a, edge.frame_b, NamesOf(same)}),
                         "Copy each camera's own pictures into its folder and push the session again."});
  std::map<std::string, CaptureId> told;
  for (const char* figure : {"first_unreadable_a_idx", "first_unreadable_b_idx", "moved_after_idx", "moved_from_idx"})
    if (const auto found = edge.figures.find(figure); found != edge.figures.end())
      told[figure] = edge.captures.at(static_cast<std::size_t>(found->second)).capture;
  AddUnused(same, "both sensors have the same file", edge);
  for (const auto& [figure, capture] : told) {
    const auto place = std::find_if(edge.captures.begin(), edge.captures.end(),
                                    [&id = capture](const CaptureResidual& one) { return one.capture == id; });
    edge.figures[figure] = static_cast<double>(std::distance(edge.captures.begin(), place));
  }
}

}  // namespace rigcal::calib

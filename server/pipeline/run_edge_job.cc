#include "server/pipeline/run_edge_job.h"

#include "server/pipeline/camera_fits.h"
#include "server/pipeline/pair_inputs.h"
#include "server/pipeline/same_pictures.h"
#include "storage/edges.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

Edge FailedEdge(const SensorPair& pair, const std::string& method, const Error& error) {
  Edge edge;
  edge.frame_a = pair.a;
  edge.frame_b = pair.b;
  edge.method = method;
  edge.diagnoses.push_back({NameOf(error.code), error.what, error.cure});
  return edge;
}

// A method from its loader and its estimator. What cannot be loaded is a failed edge, unless the store failed.
template <typename Inputs, typename Estimate>
Result<Edge> EdgeFrom(storage::Store& store, const SensorPair& pair, const std::string& method, Result<Inputs> inputs,
                      const Estimate& estimate) {
  if (!inputs) {
    if (inputs.error().code == ErrorCode::kStorage) return Fail(inputs.error());
    return FailedEdge(pair, method, inputs.error());
  }
  std::vector<CameraFit> fits;
  Edge edge = estimate(inputs->problem, &fits);
  edge.evidence = std::move(inputs->evidence);
  RIGCAL_TRY(AppendFits(store, fits, edge));
  return edge;
}

Result<Edge> StereoEdge(storage::Store& store, const Manifest& manifest, const SensorPair& pair) {
  const std::vector<CaptureId> same = SamePictures(manifest, pair);
  auto inputs = LoadStereo(store, manifest, pair);
  if (inputs) LeaveOut(same, inputs->problem);
  RIGCAL_ASSIGN(Edge edge, EdgeFrom(store, pair, "stereo", std::move(inputs), calib::EstimateEdge));
  TellLeftOut(same, edge);
  return edge;
}

// The pictures show the answer, so they are made after it.
Result<Edge> LidarLidarEdge(storage::Store& store, const Manifest& manifest, const SensorPair& pair) {
  const auto inputs = LoadLidarLidar(store, manifest, pair);
  if (!inputs && inputs.error().code == ErrorCode::kStorage) return Fail(inputs.error());
  if (!inputs) return FailedEdge(pair, "lidar_lidar", inputs.error());
  Edge edge = calib::EstimateLidarLidarEdge(inputs->problem);
  RIGCAL_TRY(AddOverlays(store, inputs->problem, edge));
  return edge;
}

template <typename Inputs>
Result<Inputs> Remembering(calib::CameraMemory& cameras, Result<Inputs> inputs) {
  if (inputs)
    inputs->problem.solve_camera = [&cameras](const calib::CameraProblem& problem) {
      return cameras.Estimate(problem);
    };
  return inputs;
}

Result<Edge> EstimatePair(storage::Store& store, const storage::JobRow& job, calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, job.session));
  if (!manifest)
    return FailedEdge(
        job.pair, "stereo",
        {ErrorCode::kNotFound, "session " + job.session.str() + " is not in the store", "Push the session again."});
  const Sensor *a = SensorOf(manifest->header, job.pair.a), *b = SensorOf(manifest->header, job.pair.b);
  const std::string method(a && b ? MethodFor(manifest->header, *a, *b) : "stereo");
  if (method == "stereo") return StereoEdge(store, *manifest, job.pair);
  if (method == "lidar_camera")
    return EdgeFrom(store, job.pair, method, Remembering(cameras, LoadLidarCamera(store, *manifest, job.pair)),
                    calib::EstimateLidarCameraEdge);
  if (method == "lidar_lidar") return LidarLidarEdge(store, *manifest, job.pair);
  if (method == "non_overlapping" || method == "tracker_camera" || method == "pose_streams")
    return EdgeFrom(store, job.pair, method, Remembering(cameras, LoadHandEye(store, *manifest, job.pair)),
                    calib::EstimateHandEyeEdge);
  if (method == "tracker_lidar")
    return EdgeFrom(store, job.pair, method, LoadTrackerLidar(store, *manifest, job.pair),
                    [](const calib::TrackerLidarProblem& problem, std::vector<CameraFit>*) {
                      return calib::EstimateTrackerLidarEdge(problem);
                    });
  return FailedEdge(
      job.pair, method.empty() ? "none" : method,
      {ErrorCode::kUnsupported, "this server has no method for " + job.pair.a.str() + " and " + job.pair.b.str(),
       "Update the server and push the session again."});
}

// What a library throws (no memory for a cloud, say) costs this pair, not the server.
Result<Edge> EstimateOrFail(storage::Store& store, const storage::JobRow& job, calib::CameraMemory& cameras) {
  try {
    return EstimatePair(store, job, cameras);
  } catch (const std::exception& exception) {
    return FailedEdge(job.pair, "none",
                      {ErrorCode::kInternal, std::string("the estimate broke off: ") + exception.what(),
                       "Push the session again with fewer captures, and report this with the session's id."});
  }
}

}  // namespace

Result<Edge> RunEdgeJob(storage::Store& store, const storage::JobRow& job, const Clock& clock,
                        calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(Edge edge, EstimateOrFail(store, job, cameras));
  edge.robot = job.robot;
  edge.session = job.session;
  edge.id = EstimatedEdgeId(job.robot, job.session, edge.method, edge.frame_a, edge.frame_b);
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendEdge(store, edge, clock.Now()));
    return storage::FinishJob(store, job.number, clock.Now());
  }));
  return edge;
}

}  // namespace rigcal::pipeline

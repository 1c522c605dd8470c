#include "server/pipeline/run_edge_job.h"

#include "server/base/log.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/camera_fits.h"
#include "server/pipeline/decoding.h"
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

// A method from its loader and its estimator. What cannot be loaded is a failed edge, unless it is our fault.
template <typename Inputs, typename Estimate>
Result<Edge> EdgeFrom(storage::Store& store, const SensorPair& pair, const std::string& method, Result<Inputs> inputs,
                      const Estimate& estimate) {
  if (!inputs) {
    if (IsOurFault(inputs.error())) return Fail(inputs.error());
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
  const auto share = TakeMemory(ToRegister(store, manifest, pair));
  if (!share) return FailedEdge(pair, "lidar_lidar", share.error());
  const auto inputs = LoadLidarLidar(store, manifest, pair);
  if (!inputs && IsOurFault(inputs.error())) return Fail(inputs.error());
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

std::string MethodOf(const Manifest& manifest, const SensorPair& pair) {
  const Sensor *a = SensorOf(manifest.header, pair.a), *b = SensorOf(manifest.header, pair.b);
  return a && b ? std::string(MethodFor(manifest.header, *a, *b)) : "stereo";
}

Result<Edge> EstimatePair(storage::Store& store, const storage::JobRow& job, calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, job.session));
  if (!manifest)
    return FailedEdge(
        job.pair, "stereo",
        {ErrorCode::kNotFound, "session " + job.session.str() + " is not in the store", "Push the session again."});
  const std::string method = MethodOf(*manifest, job.pair);
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

std::string Said(const storage::JobRow& job) {
  return job.pair.a.str() + " and " + job.pair.b.str() + " of robot " + job.robot.str() + ", session " +
         job.session.str();
}

// A pair that the server could not calibrate in so many attempts.
Result<Edge> GivenUp(storage::Store& store, const storage::JobRow& job) {
  RIGCAL_ASSIGN(const storage::Attempts attempts, storage::LoadAttempts(store, storage::WorkOfJob(job.number)));
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, job.session));
  const Error why = {ErrorCode::kInternal, WhyGivenUp(attempts, "calibrated " + Said(job)),
                     "Push the session with fewer or smaller pictures and clouds, or give the server more memory; if "
                     "that does not help, report it with the session's id and the server's log."};
  LogError(why);
  return FailedEdge(job.pair, manifest ? MethodOf(*manifest, job.pair) : "none", why);
}

Result<Edge> Committed(storage::Store& store, const storage::JobRow& job, const Clock& clock, Edge edge) {
  edge.robot = job.robot;
  edge.session = job.session;
  edge.id = EstimatedEdgeId(job.robot, job.session, edge.method, edge.frame_a, edge.frame_b);
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendEdge(store, edge, clock.Now()));
    RIGCAL_TRY(storage::EndAttempt(store, storage::WorkOfJob(job.number), storage::AttemptEnd::kDone, "", clock.Now()));
    return storage::FinishJob(store, job.number, clock.Now());
  }));
  return edge;
}

}  // namespace

Result<Edge> RunEdgeJob(storage::Store& store, const storage::JobRow& job, const Clock& clock,
                        calib::CameraMemory& cameras) {
  if (job.attempts >= kAttemptsMax) {
    RIGCAL_ASSIGN(Edge failed, GivenUp(store, job));
    return Committed(store, job, clock, std::move(failed));
  }
  const auto body = [&]() -> Result<Edge> {
    RIGCAL_ASSIGN(Edge edge, EstimatePair(store, job, cameras));
    return Committed(store, job, clock, std::move(edge));
  };
  return Attempted(store, clock, storage::WorkOfJob(job.number), Said(job), job.attempts, body);
}

}  // namespace rigcal::pipeline

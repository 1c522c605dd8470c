#include "server/pipeline/edges/run_edge_job.h"

#include "server/base/log.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/eye_to_hand/eye_to_hand.h"
#include "server/model/edges/method.h"
#include "server/model/edges/past.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/edges/decoding.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "server/pipeline/edges/pair_inputs.h"
#include "storage/edges/edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"

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

// After the reason why it failed, if it did.
void AddNotes(const std::vector<Diagnosis>& notes, Edge& edge) {
  edge.diagnoses.insert(edge.diagnoses.end(), notes.begin(), notes.end());
}

// A method from its loader and its estimator. What cannot be loaded is a failed edge, unless it is our fault.
template <typename Inputs, typename Estimate>
Result<Edge> EdgeFrom(storage::Store& store, const SensorPair& pair, Method method, Result<Inputs> inputs,
                      const Estimate& estimate) {
  if (!inputs) {
    if (IsOurFault(inputs.error())) return Fail(inputs.error());
    return FailedEdge(pair, NameOf(method), inputs.error());
  }
  std::vector<CameraFit> fits;
  Edge edge = estimate(inputs->problem, &fits);
  edge.evidence = std::move(inputs->evidence);
  AddNotes(inputs->notes, edge);
  RIGCAL_TRY(AppendFits(store, fits, edge));
  return edge;
}

// All pairs of a session leave out the same captures at once.
template <typename Inputs>
Result<Inputs> InSession(const Manifest& manifest, Result<Inputs> inputs) {
  if (inputs) inputs->problem.session_captures = RecordedCaptures(manifest);
  return inputs;
}

Result<Edge> StereoEdge(storage::Store& store, const Manifest& manifest, const SensorPair& pair) {
  const std::vector<CaptureId> same = SamePictures(manifest, pair);
  auto inputs = InSession(manifest, LoadStereo(store, manifest, pair));
  if (inputs) calib::DropCaptures(inputs->problem, {same.begin(), same.end()});
  RIGCAL_ASSIGN(Edge edge, EdgeFrom(store, pair, Method::kStereo, std::move(inputs), calib::EstimateEdge));
  calib::TellSamePictures(same, edge);
  return edge;
}

// The pictures show the answer, so they are made after it.
Result<Edge> LidarLidarEdge(storage::Store& store, const Manifest& manifest, const SensorPair& pair) {
  const auto share = TakeMemory(ToRegister(store, manifest, pair));
  if (!share) return FailedEdge(pair, NameOf(Method::kLidarLidar), share.error());
  const auto inputs = InSession(manifest, LoadLidarLidar(store, manifest, pair));
  if (!inputs && IsOurFault(inputs.error())) return Fail(inputs.error());
  if (!inputs) return FailedEdge(pair, NameOf(Method::kLidarLidar), inputs.error());
  Edge edge = calib::EstimateLidarLidarEdge(inputs->problem);
  AddNotes(inputs->notes, edge);
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

// Of methods that go by poses of either side.
template <typename Estimate>
Result<Edge> MotionEdge(storage::Store& store, const Manifest& manifest, const SensorPair& pair, Method method,
                        calib::CameraMemory& cameras, const Estimate& estimate) {
  auto inputs = InSession(manifest, LoadHandEye(store, manifest, pair, method));
  return EdgeFrom(store, pair, method, Remembering(cameras, std::move(inputs)), estimate);
}

std::optional<Method> MethodOf(const SessionHeader& header, const SensorPair& pair) {
  const Sensor *a = SensorOf(header, pair.a), *b = SensorOf(header, pair.b);
  return a && b ? MethodFor(header, *a, *b) : std::nullopt;
}

std::string MethodName(const SessionHeader& header, const SensorPair& pair) {
  const std::optional<Method> method = MethodOf(header, pair);
  return method ? NameOf(*method) : "none";
}

// Each method's loader and estimator.
Result<Edge> EstimateBy(Method method, storage::Store& store, const Manifest& manifest, const SensorPair& pair,
                        calib::CameraMemory& cameras) {
  switch (method) {
    case Method::kStereo:
      return StereoEdge(store, manifest, pair);
    case Method::kLidarCamera:
      return EdgeFrom(store, pair, method,
                      Remembering(cameras, InSession(manifest, LoadLidarCamera(store, manifest, pair))),
                      calib::EstimateLidarCameraEdge);
    case Method::kLidarLidar:
      return LidarLidarEdge(store, manifest, pair);
    case Method::kNonOverlapping:
    case Method::kPoseStreams:
      return MotionEdge(store, manifest, pair, method, cameras, calib::EstimateHandEyeEdge);
    case Method::kTrackerCamera:
      return MotionEdge(store, manifest, pair, method, cameras, calib::EstimateTrackerCameraEdge);
    case Method::kEyeToHand:
      return MotionEdge(store, manifest, pair, method, cameras, calib::EstimateEyeToHandEdge);
    case Method::kTrackerLidar:
      return EdgeFrom(store, pair, method, InSession(manifest, LoadTrackerLidar(store, manifest, pair)),
                      [](const calib::TrackerLidarProblem& problem, std::vector<CameraFit>*) {
                        return calib::EstimateTrackerLidarEdge(problem);
                      });
  }
  return Fail(ErrorCode::kInternal, "there is no such method", "Report this with the session's id.");
}

Result<Edge> EstimatePair(storage::Store& store, const storage::JobRow& job, calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, job.session));
  if (!manifest)
    return FailedEdge(
        job.pair, "none",
        {ErrorCode::kNotFound, "session " + job.session.str() + " is not in the store", "Push the session again."});
  if (const std::optional<Method> method = MethodOf(manifest->header, job.pair))
    return EstimateBy(*method, store, *manifest, job.pair, cameras);
  return FailedEdge(
      job.pair, "none",
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
  return FailedEdge(job.pair, manifest ? MethodName(manifest->header, job.pair) : "none", why);
}

// An edge, and what it could not be made from.
struct Outcome {
  Edge edge;
  std::optional<Manifest> manifest;  // that `lost` points into
  std::vector<LostFile> lost;
};

// The store failed. Where files of the pair are lost that is why, and the edge says so; else it is tried again.
Result<Outcome> FailedFor(const Error& error, storage::Store& store, const storage::JobRow& job) {
  Outcome outcome;
  RIGCAL_ASSIGN(outcome.manifest, storage::LoadManifest(store, job.session));
  if (!outcome.manifest) return Fail(error);
  std::vector<const Payload*> of_pair;
  for (const Payload& payload : outcome.manifest->payloads)
    if (payload.sensor == job.pair.a || payload.sensor == job.pair.b) of_pair.push_back(&payload);
  RIGCAL_ASSIGN(outcome.lost, FindLost(store, of_pair));
  if (outcome.lost.empty()) return Fail(error);
  outcome.edge.frame_a = job.pair.a;
  outcome.edge.frame_b = job.pair.b;
  outcome.edge.method = MethodName(outcome.manifest->header, job.pair);
  outcome.edge.diagnoses = {TellLost(job.robot, outcome.lost)};
  LogError({ErrorCode::kStorage, outcome.edge.diagnoses[0].what, outcome.edge.diagnoses[0].cure});
  return outcome;
}

Result<Outcome> Try(storage::Store& store, const storage::JobRow& job, calib::CameraMemory& cameras) {
  auto edge = EstimatePair(store, job, cameras);
  if (edge) return Outcome{std::move(*edge), std::nullopt, {}};
  if (edge.error().code != ErrorCode::kStorage) return Fail(edge.error());
  return FailedFor(edge.error(), store, job);
}

// What failed for want of a file stays in the store as it was. `is_known`: only its evidence had to be made again.
struct Place {
  EdgeId id;
  bool is_known = false;
};
Result<Place> PlaceOf(storage::Store& store, const Edge& edge) {
  Place place{EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b)};
  while (true) {
    RIGCAL_ASSIGN(const auto earlier, storage::LoadEdge(store, place.id));
    place.is_known = earlier && !FailedForLostFile(*earlier);
    if (!earlier || place.is_known) return place;
    place.id = RepeatedEdgeId(place.id);
  }
}

Result<Edge> Committed(storage::Store& store, const storage::JobRow& job, const Clock& clock, Outcome outcome) {
  Edge& edge = outcome.edge;
  edge.robot = job.robot;
  edge.session = job.session;
  RIGCAL_ASSIGN(const Place place, PlaceOf(store, edge));
  edge.id = place.id;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_TRY(AppendLost(store, outcome.lost, job.number, clock.Now()));
    RIGCAL_TRY(storage::AppendEdge(store, edge, clock.Now()));
    if (place.is_known) RIGCAL_TRY(storage::PublishAgain(store, job.robot));
    RIGCAL_TRY(storage::EndAttempt(store, storage::WorkOfJob(job.number), storage::AttemptEnd::kDone, "", clock.Now()));
    return storage::FinishJob(store, job.number, clock.Now());
  }));
  return std::move(edge);
}

}  // namespace

Result<Edge> RunEdgeJob(storage::Store& store, const storage::JobRow& job, const Clock& clock,
                        calib::CameraMemory& cameras) {
  if (job.attempts >= kAttemptsMax) {
    RIGCAL_ASSIGN(Edge failed, GivenUp(store, job));
    return Committed(store, job, clock, {std::move(failed), std::nullopt, {}});
  }
  const auto body = [&]() -> Result<Edge> {
    RIGCAL_ASSIGN(Outcome outcome, Try(store, job, cameras));
    return Committed(store, job, clock, std::move(outcome));
  };
  return Attempted(store, clock, storage::WorkOfJob(job.number), Said(job), job.attempts, body);
}

}  // namespace rigcal::pipeline

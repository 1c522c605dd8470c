#include "server/pipeline/run_edge_job.h"

#include "server/calib/stereo.h"
#include "server/pipeline/stereo_inputs.h"
#include "storage/edges.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

constexpr const char* kStereo = "stereo";

Edge FailedEdge(const SensorPair& pair, const Error& error) {
  Edge edge;
  edge.frame_a = pair.a;
  edge.frame_b = pair.b;
  edge.method = kStereo;
  edge.diagnoses.push_back({NameOf(error.code), error.what, error.cure});
  return edge;
}

Result<Edge> EstimatePair(storage::Store& store, const storage::JobRow& job) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, job.session));
  if (!manifest)
    return FailedEdge(job.pair, {ErrorCode::kNotFound, "session " + job.session.str() + " is not in the store",
                                 "Push the session again."});
  auto inputs = LoadStereoInputs(store, *manifest, job.pair);
  if (!inputs) {
    if (inputs.error().code == ErrorCode::kStorage) return Fail(inputs.error());
    return FailedEdge(job.pair, inputs.error());
  }
  Edge edge = calib::EstimateEdge(inputs->problem);
  edge.evidence = std::move(inputs->evidence);
  return edge;
}

}  // namespace

Result<Edge> RunEdgeJob(storage::Store& store, const storage::JobRow& job, const Clock& clock) {
  RIGCAL_ASSIGN(Edge edge, EstimatePair(store, job));
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

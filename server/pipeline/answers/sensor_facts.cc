#include "server/pipeline/answers/sensor_facts.h"

#include <map>
#include <set>

#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "server/pipeline/sessions/refined_lenses.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {
namespace {

struct ToldBySessions {
  std::map<SessionId, Stamp> captured_at;
  std::map<SensorId, std::pair<Stamp, SensorKind>> kinds;  // with the time of the session that says it
};

void TakeKinds(const SessionHeader& header, ToldBySessions& told) {
  for (const Sensor& sensor : header.sensors) {
    const auto [at, fresh] = told.kinds.try_emplace(sensor.id, header.captured_at, sensor.kind);
    if (!fresh && at->second.first < header.captured_at) at->second = {header.captured_at, sensor.kind};
  }
}

Result<ToldBySessions> LoadTold(storage::Store& store, const std::vector<Edge>& edges) {
  std::set<SessionId> ids;
  for (const Edge& edge : edges)
    if (!edge.session.empty()) ids.insert(edge.session);
  ToldBySessions told;
  for (const SessionId& id : ids) {
    RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, id));
    if (!manifest) continue;
    told.captured_at.emplace(id, manifest->header.captured_at);
    TakeKinds(manifest->header, told);
  }
  return told;
}

void TakeFit(report::CameraReport& camera, formats::SensorFacts& sensor) {
  camera.fit.views.clear();
  sensor.camera = std::move(camera.fit);
  sensor.edge = camera.edge;
  sensor.refined_in = camera.refined_in;
}

}  // namespace

Result<formats::SensorFactsOfRevision> LoadSensorFacts(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const formats::RevisionInput whole, LoadWholeRevision(store, revision, Blocks::kLeftOut));
  RIGCAL_ASSIGN(const ToldBySessions told, LoadTold(store, whole.edges));
  RIGCAL_ASSIGN(auto cameras, LoadFits(store, report::ChooseFits(whole, told.captured_at)));
  RIGCAL_TRY(TakeRefinedLenses(store, whole, cameras));
  formats::SensorFactsOfRevision facts{revision.robot, revision.number, {}};
  for (const SensorPose& pose : whole.solution.poses) {
    formats::SensorFacts sensor{pose.sensor};
    if (const auto kind = told.kinds.find(pose.sensor); kind != told.kinds.end()) sensor.kind = kind->second.second;
    for (report::CameraReport& camera : cameras)
      if (camera.fit.camera == pose.sensor) TakeFit(camera, sensor);
    facts.sensors.push_back(std::move(sensor));
  }
  return facts;
}

}  // namespace rigcal::pipeline

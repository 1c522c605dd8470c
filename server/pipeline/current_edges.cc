#include "server/pipeline/current_edges.h"

#include <set>

#include "server/model/past.h"
#include "server/pipeline/remounts.h"
#include "storage/edges.h"
#include "storage/merged_edges.h"

namespace rigcal::pipeline {
namespace {

// The edge stays visible, with its reason, but takes no part.
void MakePast(std::string_view code, std::string what, std::string cure, Edge& edge) {
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {{std::string(code), std::move(what), std::move(cure)}};
}

void Supersede(const Superseding& superseding, Edge& edge) {
  const std::string old = edge.session.str().substr(0, 16), by = superseding.by.str().substr(0, 16);
  const std::string people = superseding.operator_name.empty() ? "" : ", by " + superseding.operator_name;
  MakePast(kSupersededCode,
           "session " + old + " is superseded by session " + by + " of the same pictures (captured " +
               ToIso(superseding.captured_at) + people + ")",
           "Nothing, if session " + by + " is the right one; else `rigcal restore " + old + "` takes it back.", edge);
}

void SupersedeWhatWasRunAgain(std::vector<Edge>& edges) {
  std::set<EdgeId> ids;
  for (const Edge& edge : edges) ids.insert(edge.id);
  for (Edge& edge : edges)
    if (FailedForLostFile(edge) && ids.contains(RepeatedEdgeId(edge.id)))
      MakePast(kSupersededCode,
               "files of session " + edge.session.str().substr(0, 16) +
                   " that the server's disk had not kept were sent again",
               "Nothing: the edge that was made from them then counts.", edge);
}

void MakePast(const SessionId& session, const Word& retired, Edge& edge) {
  MakePast(kRetiredCode, "session " + session.str().substr(0, 16) + " was " + RetiredText(retired),
           BringsBack(RestoreCommand(session)), edge);
}

void MakePast(const RetiredSensor& gone, Edge& edge) {
  MakePast(kSensorRetiredCode, RetiredText(gone), BringsBack(RestoreCommand(edge.robot, gone.sensor)), edge);
}

void MakePast(const Word& retired, Edge& edge) {
  MakePast(kRetiredCode, RetiredText(retired),
           "Push the right value: as another edge it counts. If this one is right, " + BringsBack(RestoreCommand(edge.id)), edge);
}

void MakePastWhatWasRetired(const storage::WhatCounts& counts, Edge& edge) {
  if (const auto found = counts.retired_sessions.find(edge.session); found != counts.retired_sessions.end())
    MakePast(edge.session, found->second.word, edge);
  for (const SensorId& sensor : {edge.frame_b, edge.frame_a})
    if (const auto found = counts.retired_sensors.find(sensor); found != counts.retired_sensors.end())
      MakePast(RetiredSensor{sensor, found->second.word}, edge);
  if (const auto found = counts.retired.find(edge.id); found != counts.retired.end()) MakePast(found->second.word, edge);
}

void MakePast(const storage::Remount& remount, Edge& edge) {
  MakePast(kRemountedCode,
           "sensor " + remount.sensor.str() + " was remounted after this was measured, says session " +
               remount.session.str().substr(0, 16),
           "Where no later session measured this pair, measure it anew; where one did, that one counts.", edge);
}

Status MakePastWhatWasRemounted(storage::Store& store, const std::vector<storage::Remount>& all, std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (!edge.session.empty()) sessions.insert(edge.session);
  RIGCAL_ASSIGN(const Remounts remounts, Remounts::Load(store, {sessions.begin(), sessions.end()}, all));
  for (Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b}) {
      const auto* remount =
          edge.measured_at ? remounts.After(*edge.measured_at, sensor) : remounts.After(edge.session, sensor);
      if (remount != nullptr && edge.state == EdgeState::kGood) MakePast(*remount, edge);
    }
  return {};
}

}  // namespace

Status MarkPast(storage::Store& store, const storage::WhatCounts& counts, std::vector<Edge>& edges) {
  for (Edge& edge : edges) {
    if (const auto found = counts.superseded.find(edge.session); found != counts.superseded.end()) Supersede(found->second, edge);
    MakePastWhatWasRetired(counts, edge);
  }
  SupersedeWhatWasRunAgain(edges);
  return MakePastWhatWasRemounted(store, counts.remounts, edges);
}

Result<CurrentEdges> LoadCurrentEdges(storage::Store& store, const RobotId& robot, storage::EdgeParts parts) {
  CurrentEdges current;
  std::vector<Edge>& edges = current.edges;
  RIGCAL_ASSIGN(current.counts, storage::LoadWhatCounts(store, robot));
  RIGCAL_ASSIGN(current.all, storage::IsMergeOutdated(store, robot, current.counts));
  if (current.all) {
    RIGCAL_ASSIGN(edges, storage::LoadEdges(store, robot, parts == storage::EdgeParts::kAll));
  } else {
    RIGCAL_ASSIGN(edges, storage::LoadUnmergedEdges(store, robot, parts));
    RIGCAL_ASSIGN(current.merged, storage::LoadMergedEdges(store, robot));
  }
  RIGCAL_TRY(MarkPast(store, current.counts, edges));
  return current;
}

Result<std::vector<Edge>> LoadEdgesWithin(storage::Store& store, const CurrentEdges& current,
                                          const std::vector<SessionId>& sessions) {
  std::set<SessionId> wanted(sessions.begin(), sessions.end());
  for (const Edge& edge : current.edges) wanted.erase(edge.session);
  if (wanted.empty()) return std::vector<Edge>();
  RIGCAL_ASSIGN(std::vector<Edge> edges, storage::LoadEdgeRows(store, {wanted.begin(), wanted.end()}));
  RIGCAL_TRY(MarkPast(store, current.counts, edges));
  return edges;
}

}  // namespace rigcal::pipeline

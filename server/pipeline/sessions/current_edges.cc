#include "server/pipeline/sessions/current_edges.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/model/edges/past.h"
#include "server/model/edges/weak_edge.h"
#include "storage/edges/edges.h"
#include "storage/revisions/merged_edges.h"
#include "storage/sessions/epochs.h"

namespace rigcal::pipeline {
namespace {

template <typename IsSo>
const Epoch* FirstOf(const std::vector<Epoch>& epochs, const IsSo& is_so) {
  const auto found = std::find_if(epochs.begin(), epochs.end(), is_so);
  return found != epochs.end() ? &*found : nullptr;
}

bool ByPerson(const Epoch& epoch) { return epoch.cause == EpochCause::kPerson; }

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
  MakePast(
      kRetiredCode, RetiredText(retired),
      "Push the right value: as another edge it counts. If this one is right, " + BringsBack(RestoreCommand(edge.id)),
      edge);
}

void MakePastWhatWasRetired(const storage::WhatCounts& counts, Edge& edge) {
  if (const auto found = counts.retired_sessions.find(edge.session); found != counts.retired_sessions.end())
    MakePast(edge.session, found->second.word, edge);
  for (const SensorId& sensor : {edge.frame_b, edge.frame_a})
    if (const auto found = counts.retired_sensors.find(sensor); found != counts.retired_sensors.end())
      MakePast(RetiredSensor{sensor, found->second.word}, edge);
  if (const auto found = counts.retired.find(edge.id); found != counts.retired.end())
    MakePast(found->second.word, edge);
}

std::string WhyEpoch(const Epoch& epoch) {
  const std::string by_session = ", says session " + epoch.session.str().substr(0, 16);
  if (epoch.cause == EpochCause::kRemounted)
    return "sensor " + epoch.sensor.str() + " was remounted after this was measured" + by_session;
  if (epoch.cause == EpochCause::kPerson)
    return TextOf(epoch) + " (" + ToIso(epoch.begins_at) + "), after this was measured";
  return TextOf(epoch) + ", when this was measured" + by_session;
}

void MakePast(const Epoch& epoch, Edge& edge) {
  MakePast(epoch.cause == EpochCause::kRemounted ? kRemountedCode : kEpochCode, WhyEpoch(epoch),
           "Where no later session measured this pair, measure it anew; where one did, that one counts.", edge);
}

// Of edges of which nobody knows when they were measured: when they were stored, where a person began an epoch.
Result<std::map<EdgeId, Stamp>> StoredAt(storage::Store& store, const std::vector<Epoch>& epochs,
                                         const std::vector<Edge>& edges) {
  std::map<EdgeId, Stamp> stored_at;
  const auto by_person = [](const Epoch& epoch) { return epoch.cause == EpochCause::kPerson; };
  if (std::none_of(epochs.begin(), epochs.end(), by_person)) return stored_at;
  std::vector<Edge> undated;
  for (const Edge& edge : edges)
    if (edge.session.empty() && !edge.measured_at && edge.state == EdgeState::kGood) undated.push_back(edge);
  if (undated.empty()) return stored_at;
  return storage::LoadMeasuredAt(store, undated);
}

const Epoch* EpochAfter(const Epochs& epochs, const std::map<EdgeId, Stamp>& stored_at, const Edge& edge,
                        const SensorId& sensor) {
  if (edge.measured_at) return epochs.After(*edge.measured_at, sensor);
  const auto stored = stored_at.find(edge.id);
  return stored == stored_at.end() ? epochs.After(edge.session, sensor) : epochs.SaidAfter(stored->second, sensor);
}

Status MakePastWhatIsOfEarlierEpochs(storage::Store& store, const std::vector<Epoch>& all, std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (!edge.session.empty()) sessions.insert(edge.session);
  RIGCAL_ASSIGN(const Epochs epochs, Epochs::Load(store, {sessions.begin(), sessions.end()}, all));
  RIGCAL_ASSIGN(const auto stored_at, StoredAt(store, all, edges));
  for (Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b}) {
      const Epoch* epoch = EpochAfter(epochs, stored_at, edge, sensor);
      if (epoch != nullptr && edge.state == EdgeState::kGood) MakePast(*epoch, edge);
    }
  return {};
}

}  // namespace

Result<Epochs> Epochs::Load(storage::Store& store, const RobotId& robot) {
  Epochs loaded;
  RIGCAL_ASSIGN(loaded.epochs_, storage::LoadEpochs(store, robot));
  if (loaded.epochs_.empty()) return loaded;
  RIGCAL_ASSIGN(loaded.captured_at_, storage::LoadCapturedAt(store, robot));
  return loaded;
}

Result<Epochs> Epochs::Load(storage::Store& store, const std::vector<SessionId>& sessions,
                            const std::vector<Epoch>& epochs) {
  Epochs loaded;
  loaded.epochs_ = epochs;
  if (epochs.empty()) return loaded;
  RIGCAL_ASSIGN(loaded.captured_at_, storage::LoadCapturedAt(store, sessions));
  return loaded;
}

bool Epochs::Names(const SessionId& session, const SensorId& sensor) const {
  return std::any_of(epochs_.begin(), epochs_.end(),
                     [&](const Epoch& epoch) { return epoch.session == session && epoch.sensor == sensor; });
}

// Of two sessions of one time, a day say, that which names the sensor is the later; if both do, nobody knows.
const Epoch* Epochs::After(const SessionId& session, const SensorId& sensor) const {
  const auto measured = captured_at_.find(session);
  if (measured == captured_at_.end()) return nullptr;
  return FirstOf(epochs_, [&](const Epoch& epoch) {
    if (epoch.sensor != sensor) return false;
    if (measured->second != epoch.begins_at) return measured->second < epoch.begins_at;
    return !ByPerson(epoch) && !Names(session, sensor);
  });
}

const Epoch* Epochs::After(Stamp measured_at, const SensorId& sensor) const {
  return FirstOf(epochs_, [&](const Epoch& epoch) {
    if (epoch.sensor != sensor) return false;
    return ByPerson(epoch) ? measured_at < epoch.begins_at : measured_at <= epoch.begins_at;
  });
}

const Epoch* Epochs::SaidAfter(Stamp stored_at, const SensorId& sensor) const {
  return FirstOf(epochs_, [&](const Epoch& epoch) {
    return epoch.sensor == sensor && ByPerson(epoch) && stored_at < epoch.begins_at;
  });
}

Status MarkPast(storage::Store& store, const storage::WhatCounts& counts, std::vector<Edge>& edges) {
  for (Edge& edge : edges) {
    if (const auto found = counts.superseded.find(edge.session); found != counts.superseded.end())
      Supersede(found->second, edge);
    MakePastWhatWasRetired(counts, edge);
  }
  SupersedeWhatWasRunAgain(edges);
  return MakePastWhatIsOfEarlierEpochs(store, counts.epochs, edges);
}

Result<CurrentEdges> LoadCurrentEdges(storage::Store& store, const RobotId& robot, storage::EdgeParts parts,
                                      bool merge_anew) {
  CurrentEdges current;
  std::vector<Edge>& edges = current.edges;
  RIGCAL_ASSIGN(current.counts, storage::LoadWhatCounts(store, robot));
  RIGCAL_ASSIGN(const bool is_outdated, storage::IsMergeOutdated(store, robot, current.counts));
  current.all = is_outdated || merge_anew;
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
  std::erase_if(edges, [](const Edge& edge) { return !WhyWeak(edge).empty(); });
  return edges;
}

bool HasWeak(const CurrentEdges& current) {
  const auto is_weak = [](const Edge& edge) { return !WhyWeak(edge).empty(); };
  return std::any_of(current.edges.begin(), current.edges.end(), is_weak) ||
         std::any_of(current.merged.begin(), current.merged.end(), [](const MergedEdge& one) { return one.weak; });
}

}  // namespace rigcal::pipeline

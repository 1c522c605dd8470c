// READ: the edges of a robot as its next revision sees them, and the epochs of its sensors by which some are past.
#pragma once

#include <map>
#include <vector>

#include "server/model/approval/epoch.h"
#include "server/model/approval/standing.h"
#include "server/model/edges/merged_edge.h"
#include "storage/edges/edges.h"
#include "storage/revisions/merged_edges.h"
#include "storage/sessions/sessions.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// When epochs of a robot's sensors began (server/model/approval/epoch.h), beside when its sessions were captured.
class Epochs {
 public:
  // Of all closed sessions of the robot that count.
  [[nodiscard]] static Result<Epochs> Load(storage::Store& store, const RobotId& robot);
  // With those that were loaded; After() then knows these sessions only.
  [[nodiscard]] static Result<Epochs> Load(storage::Store& store, const std::vector<SessionId>& sessions,
                                           const std::vector<Epoch>& epochs);
  // The earliest epoch of the sensor that began after this session was captured; null: none. What has no session has no
  // date.
  [[nodiscard]] const Epoch* After(const SessionId& session, const SensorId& sensor) const;
  // Likewise, of what was measured at that time. Of one time what a session says is the later, what a person says the
  // earlier: an epoch begins with what is measured from then on.
  [[nodiscard]] const Epoch* After(Stamp measured_at, const SensorId& sensor) const;
  // Likewise, of those that a person began, of what was stored at that time and measured nobody knows when: before,
  // anyhow.
  [[nodiscard]] const Epoch* SaidAfter(Stamp stored_at, const SensorId& sensor) const;

 private:
  [[nodiscard]] bool Names(const SessionId& session, const SensorId& sensor) const;

  std::vector<Epoch> epochs_;  // the earliest first
  std::map<SessionId, Stamp> captured_at_;
};

// All of them, past ones too.
struct CurrentEdges {
  std::vector<Edge> edges;         // that are in no merged edge, good and failed, sorted by id
  std::vector<MergedEdge> merged;  // what the newest revision made of the others
  bool all = false;                // what it made of them holds no more: `edges` are all
  storage::WhatCounts counts;      // by which edges are past
};
// Edges that were retired, those of a session or sensor that was, those of a superseded session, and those of a sensor
// of which an epoch began since (it was remounted, say) are failed, with that as their only diagnosis (IsPast). Where
// that changes for edges that were merged, or with `merge_anew`, no edge is merged. Call within one Read.
[[nodiscard]] Result<CurrentEdges> LoadCurrentEdges(storage::Store& store, const RobotId& robot,
                                                    storage::EdgeParts parts, bool merge_anew);
// Of sessions whose edges are not among `current`: ids, ends and state, past ones with their reason; not weak ones,
// which newer visits speak for. Call within one Read.
[[nodiscard]] Result<std::vector<Edge>> LoadEdgesWithin(storage::Store& store, const CurrentEdges& current,
                                                        const std::vector<SessionId>& sessions);
// Whether the graph depends on when edges were measured (graph/solve/weak_edges.h).
[[nodiscard]] bool HasWeak(const CurrentEdges& current);
// Edges that do not count are failed, with the reason as their only diagnosis (IsPast): of several reasons what a
// person said of the edge itself, of its sensor, of its session, in this order.
[[nodiscard]] Status MarkPast(storage::Store& store, const storage::WhatCounts& counts, std::vector<Edge>& edges);

}  // namespace rigcal::pipeline

// One robot's visits through the server's own steps, as its pipeline takes them (revisions/revise.cc, as_found.cc):
// the calibration in use is tested, then a revision is made of the newest visits' estimates.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <vector>

#include "server/fleet/as_found/as_found.h"
#include "server/model/edges/merged_edge.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::drawn_fleet {

class RobotHistory {
 public:
  RobotHistory(RobotId robot, SensorId reference) : robot_(std::move(robot)), reference_(std::move(reference)) {}

  // What other robots scatter by, as of now: by it the next revision is fused.
  void Know(PooledScatter pooled) { pooled_ = std::move(pooled); }
  // What its own visits tell others, by the newest revision: not of sensors that moved between visits.
  [[nodiscard]] const std::map<SensorId, VisitScatter>& OwnScatter() const { return own_scatter_; }

  [[nodiscard]] bool HasRevision() const { return !in_use_.poses.empty(); }
  // The session against what is in use. `moved_on_purpose`: its header says so.
  [[nodiscard]] fleet::AsFoundInput InputOf(const SessionEstimate& estimate,
                                            std::set<SensorId> moved_on_purpose = {}) const;
  [[nodiscard]] AsFound Test(const SessionEstimate& estimate, std::set<SensorId> moved_on_purpose = {}) const;
  // What sessions of before say of the sensor counts no more.
  void BeginEpoch(const SensorId& sensor);
  // The revision with it, in use from now on but where it fails for a move between sessions.
  void Take(SessionEstimate estimate, Stamp captured_at);
  // Does the newest revision say that a sensor was moved between two of its visits?
  [[nodiscard]] bool SaysMoved() const { return says_moved_; }
  // Does it warn, or remark, that one sat elsewhere on another visit, by the policy that holds unless told otherwise?
  [[nodiscard]] bool WarnsOfApart() const { return warns_of_apart_; }
  [[nodiscard]] bool RemarksOnApart() const { return remarks_on_apart_; }
  // The poses that the newest revision tells.
  [[nodiscard]] const fleet::KnownPoses& Newest() const { return newest_; }
  [[nodiscard]] int Visits() const { return static_cast<int>(newest_first_.size()); }
  // With what a revision's visits say of how a place goes on changing.
  void AddRates(AsFound& found) const;

 private:
  std::vector<Edge> EdgesOf(const SessionEstimate& estimate) const;
  std::vector<Edge> MergeOlder();
  void Revise(const std::vector<Edge>& within);
  void KeepOwnScatter(const GraphSolution& solution);

  RobotId robot_;
  SensorId reference_;
  std::deque<SessionEstimate> newest_first_;
  std::map<SessionId, Stamp> captured_at_;
  std::set<std::pair<SessionId, SensorId>> of_before_;  // what a session says of a sensor that moved since
  std::vector<Edge> all_, window_;
  std::vector<MergedEdge> merged_;
  std::map<EdgeId, Stamp> measured_at_;
  fleet::KnownPoses in_use_, newest_;
  PooledScatter pooled_;
  std::map<SensorId, VisitScatter> own_scatter_;
  bool says_moved_ = false, warns_of_apart_ = false, remarks_on_apart_ = false;
};

}  // namespace rigcal::drawn_fleet

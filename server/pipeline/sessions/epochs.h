// READ: when epochs of a robot's sensors began (server/model/approval/epoch.h), beside when its sessions were captured.
#pragma once

#include <map>
#include <vector>

#include "server/model/approval/epoch.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {

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

}  // namespace rigcal::pipeline

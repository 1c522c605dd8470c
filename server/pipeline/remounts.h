// READ: which sensors of a robot were moved on purpose, and after which of its sessions.
#pragma once

#include <map>
#include <vector>

#include "storage/sessions.h"

namespace rigcal::pipeline {

class Remounts {
 public:
  // Of all closed sessions of the robot that count.
  [[nodiscard]] static Result<Remounts> Load(storage::Store& store, const RobotId& robot);
  // With those that were loaded; After() then knows these sessions only.
  [[nodiscard]] static Result<Remounts> Load(storage::Store& store, const std::vector<SessionId>& sessions,
                                             const std::vector<storage::Remount>& remounts);
  // The earliest remount of the sensor after this session was captured; null: none. What has no session has no date.
  [[nodiscard]] const storage::Remount* After(const SessionId& session, const SensorId& sensor) const;
  // Likewise, of what was measured at that time. Of one time the remount is the later.
  [[nodiscard]] const storage::Remount* After(Stamp measured_at, const SensorId& sensor) const;

 private:
  [[nodiscard]] bool Names(const SessionId& session, const SensorId& sensor) const;

  std::vector<storage::Remount> remounts_;  // the earliest captured first
  std::map<SessionId, Stamp> captured_at_;
};

}  // namespace rigcal::pipeline

// Which pairs of sensors the session will calibrate, and how well: the server's own estimators on what was detected.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "client/check/cameras.h"
#include "client/check/seen.h"
#include "server/model/edges/edge.h"
#include "server/model/edges/method.h"

namespace rigcal::check {

struct PairFound {
  SensorPair pair;
  Method method = Method::kStereo;
  CapturesNeeded needed;  // enough: where it closes a loop, to be tested against the others of it
  // Different captures in which both see what the method goes by; of a lidar those that have a cloud, for boards are
  // not looked for in clouds. 0 of a method that does not go by captures.
  std::size_t both = 0;
  std::optional<Edge> edge;          // as the server would find it; absent: the pair was only counted
  std::optional<Diagnosis> problem;  // where there is no edge: why the server would have none, either
  bool is_checked = false;           // by the others of a loop that it closes

  // The pose will be told whole, as far as was looked.
  [[nodiscard]] bool IsWhole() const;
};

// Pairs done and in all; may be empty. Called one at a time, from any thread.
using PairProgress = std::function<void(std::int64_t, std::int64_t)>;
// Of PairsToCalibrate(), in its order. Cameras before boards, with trackers, and pose streams are estimated; pairs with
// a lidar are counted. Pure but for `lenses`; deterministic. Throws std::bad_alloc.
[[nodiscard]] std::vector<PairFound> FindPairs(const SessionSeen& session,
                                               const std::map<SensorId, CameraFound>& cameras,
                                               calib::CameraMemory& lenses, const PairProgress& progress);

}  // namespace rigcal::check

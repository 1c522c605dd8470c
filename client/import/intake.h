// The first way through a bag: when each mapped sensor measured, and the poses of those that have poses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "client/import/rig_map.h"
#include "server/math/se3.h"

namespace rigcal::importing {

// Of one sensor. `stamps_ns`, on the rig's clock where rig.yaml states an offset, `ordinals` and, of a tracker or pose
// stream, `poses`, else `message_bytes`, go together.
struct SensorIntake {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::uint32_t> ordinals;  // which message of its topic, from 0
  std::vector<Se3> poses;
  std::vector<std::uint32_t> message_bytes;
  double file_ratio = 1;       // bytes of a file without compression to those of a message, of a picture's encoding
  std::uint32_t messages = 0;  // of its topic
  std::int64_t refused = 0;    // that have no stamp, or no pose that can be read
  std::string first_refusal;
  std::string camera_change;  // of a camera: what SensorOutcome has
};

struct Intake {
  std::vector<SensorIntake> sensors;  // as the map's
  Stamp first;                        // when the first message of the bag was recorded
  std::vector<Error> damage;
};

using Progress = std::function<void(std::int64_t done, std::int64_t total)>;
// kInvalidInput: more than kStampsMax messages of mapped sensors in all; a mapped topic that the bag does not have,
// with those that it has.
[[nodiscard]] Result<Intake> TakeIn(const std::filesystem::path& bag, const RigMap& map, const Progress& progress);

constexpr std::size_t kStampsMax = 2'000'000;

}  // namespace rigcal::importing

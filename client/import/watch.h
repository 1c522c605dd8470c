// The way through a bag that looks at pictures: what each shows of the board, before it is known which are captures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/import/intake.h"
#include "client/import/rig_map.h"
#include "client/moments/sight.h"

namespace rigcal::importing {

// Of one sensor.
struct WatchedPictures {
  std::vector<moments::Sight> sights;  // of a camera: one for each stamp of its intake
  std::int64_t unreadable = 0;         // that show nothing for that reason
  std::string first_trouble;
};

constexpr std::size_t kWatchedPicturesMax = 250'000;  // of all cameras; a sight takes some 400 bytes

// As the map's sensors. Cameras side by side, each in the order of the bag. kInvalidInput: more than
// kWatchedPicturesMax pictures.
[[nodiscard]] Result<std::vector<WatchedPictures>> WatchPictures(const std::filesystem::path& bag, const RigMap& map,
                                                                 const Intake& intake, const Progress& progress);

// Of the header's targets, those that a camera may see.
[[nodiscard]] std::vector<const Target*> TargetsOf(const SessionHeader& header, const Sensor& camera);

}  // namespace rigcal::importing

// READ and detect: the captures of one camera pair as calib wants them, and the pictures that show what was found.
#pragma once

#include <vector>

#include "server/calib/stereo.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct StereoInputs {
  calib::StereoProblem problem;
  std::vector<Evidence> evidence;  // annotated pictures, in capture order, camera a before camera b
};
// Of the targets that both cameras may see, the one found by both in most captures (the first, if equal).
[[nodiscard]] Result<StereoInputs> LoadStereoInputs(storage::Store& store, const Manifest& manifest,
                                                    const SensorPair& pair);

}  // namespace rigcal::pipeline

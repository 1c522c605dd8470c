// Which edge speaks for a camera: several edges estimate it, each from captures of its own.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/formats/documents.h"
#include "server/model/sensors/camera_fit.h"
#include "server/model/sensors/projection_map.h"

namespace rigcal::report {

struct FitChoice {
  SensorId camera;
  EdgeId edge;
  Digest document;  // of its fit
};
// One per camera that an edge has a fit of, sorted by name: of a good edge rather than a failed one, of the newest
// session, of the most captures used.
[[nodiscard]] std::vector<FitChoice> ChooseFits(const formats::RevisionInput& revision,
                                                const std::map<SessionId, Stamp>& captured_at);

struct CameraReport {
  CameraFit fit;  // its lens that of `refined_in`, its views as the camera's own pictures were fitted
  EdgeId edge;
  Digest document;
  SessionId refined_in = {};  // whose refinement as a whole the lens is of; none: of the camera's own pictures
  std::optional<ProjectionUncertainty> uncertainty = {};  // absent: the fit has no covariance
};

}  // namespace rigcal::report

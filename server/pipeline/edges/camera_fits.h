// What an edge says of its cameras, kept beside it as documents (formats/edges/camera_fit.h).
#pragma once

#include <vector>

#include "server/model/edges/edge.h"
#include "server/model/sensors/camera_fit.h"
#include "server/report/cameras/camera_choice.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Each camera's fit becomes a blob and an Evidence of the edge; a camera that never saw the board has none.
[[nodiscard]] Status AppendFits(storage::Store& store, const std::vector<CameraFit>& fits, Edge& edge);
// READ: of the edges that the report takes. A document that is gone or damaged is left out: the report says that there
// is none. kUnreachable where they are not to be had now.
[[nodiscard]] Result<std::vector<report::CameraReport>> LoadFits(storage::Store& store,
                                                                 const std::vector<report::FitChoice>& choices);

}  // namespace rigcal::pipeline

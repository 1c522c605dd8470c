// A charuco board whose layout is described wrong.
#pragma once

#include <vector>

#include "server/model/board_layout.h"
#include "server/model/diagnosis.h"
#include "server/model/target.h"

namespace rigcal::calib {

// "board_layout": the pictures of these captures show it (ShowsOtherLayout).
[[nodiscard]] Diagnosis OtherLayout(const SensorId& camera, const Target& board,
                                    const std::vector<CaptureId>& captures);
// Of a failed edge: a board that is described wrong comes before everything that follows from it.
void PutLayoutFirst(std::vector<Diagnosis>& diagnoses);

}  // namespace rigcal::calib

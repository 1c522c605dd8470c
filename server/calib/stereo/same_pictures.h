// What becomes of captures in which two sensors have one and the same file.
#pragma once

#include <vector>

#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

// `same` as SamePictures() of session.h.
void LeaveOut(const std::vector<CaptureId>& same, StereoProblem& problem);
// The edge says which captures were left out ("same_picture") and lists them as not used; figures that tell places in
// the list ("first_unreadable_a_idx") go on naming the same captures. Nothing if `same` is empty.
void TellLeftOut(const std::vector<CaptureId>& same, Edge& edge);

}  // namespace rigcal::calib

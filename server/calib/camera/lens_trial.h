// Which lens model foretells pictures that it was not fitted to: each is fitted with a part of the captures left out
// and judged on these.
#pragma once

#include <map>

#include "server/calib/camera/intrinsics.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib {

// `present`: the estimate of these views that is in use. `group_of_capture`: captures of one group (a burst from one
// place) are alike and left out together; groups are numbered in time; captures without one take no part.
//
// Radtan, rational and KB4, and the camera's own model, are fitted to all views from scratch, then five times without a
// fifth of the groups, contiguous in time; of each view left out the board's pose alone is fitted again. What is in use
// is judged likewise: given intrinsics as they are, others refined again within what pulls them. No view counts more
// than three times the middle one (one that a lens gives no pose is worse than any), so that a wrong picture does not
// decide.
//
// A model is surely better than another where its rms is smaller by 5 % and the mean over groups of log(rms / rms) is
// beyond its standard error by what chance makes once in 740 times (three sigmas, by Student's t). Proposed is, of the
// models surely better than what is in use, the one of least rms, or one that it is not surely better than: the
// camera's own model, then one that only adds terms to it, then radtan, KB4, rational.
//
// Nothing is tried with less than six groups, or where what is in use cannot be fitted again. At most 60 views and some
// 6,000 corners, evenly spread. Pure and deterministic.
[[nodiscard]] LensTrial TryLenses(const CameraProblem& problem, const CameraEstimate& present,
                                  const std::map<CaptureId, int>& group_of_capture);

}  // namespace rigcal::calib

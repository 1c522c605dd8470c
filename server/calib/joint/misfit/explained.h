// What is behind a session besides one rig before boards that stand still: sensors and boards that were moved and
// lenses that bend, taken out one after the other.
#pragma once

#include <optional>

#include "server/calib/joint/misfit/lens_misfit.h"
#include "server/calib/joint/misfit/moved_pose.h"
#include "server/calib/joint/problem/session_start.h"

namespace rigcal::calib::joint {

// A session as it is explained so far: a sensor or board that was moved is two of one name, a lens that bends has its
// field held in the state.
struct Explained {
  SessionStart start;
  Refined refined;
  FoundMisfits misfits;
  // Of lidars and boards, and of entrance pupils, if it was asked for.
  std::optional<Refined> with_effects_free = std::nullopt, with_pupils_free = std::nullopt;
};

// Fails as Refine does.
[[nodiscard]] Result<Explained> Explain(SessionStart start, const CaptureGroups& groups);

// Whether `one` leaves less of the same looks than `other`, beyond doubt and for what it had to choose from.
[[nodiscard]] bool ExplainsMore(const Explained& one, const Explained& other);

// With all that is found, poses too: of a sensor or a board that moved those before and after. What moved is added to
// `told`, the one that explains most first.
[[nodiscard]] Explained ExplainAll(Explained now, SessionEstimate& told);

}  // namespace rigcal::calib::joint

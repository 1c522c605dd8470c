// Which captures belong together. Captures from one place have pictures that are wrong alike (light, blur, places on
// the pixels), whenever they were taken; in a row they are a burst. Groups are what the covariance takes as independent
// of each other.
#pragma once

#include "server/calib/joint/problem/session_problem.h"

namespace rigcal::calib::joint {

struct CaptureGroups {
  std::vector<int> view_of_place;   // places that are near one another have one number
  std::vector<int> group_of_place;  // whole bursts, contiguous in time; ascending from 0
  bool are_merged = false;  // of several bursts each: what happens at a group happens within it or the one before

  friend bool operator==(const CaptureGroups&, const CaptureGroups&) = default;
  // How many groups; 0 without places.
  [[nodiscard]] int groups() const { return group_of_place.empty() ? 0 : group_of_place.back() + 1; }
};

// At most `groups_max` groups of nearly as many bursts each.
[[nodiscard]] CaptureGroups GroupsOf(const SessionProblem& problem, const SessionState& state, int groups_max = 40);

// Looks of corners by one sensor at one board from one view, as indices of problem.corners; only of views with several.
[[nodiscard]] std::vector<std::vector<std::size_t>> RepeatsOfCorners(const SessionProblem& problem,
                                                                     const CaptureGroups& groups);

}  // namespace rigcal::calib::joint

// What failed pairs have in common, and what else is wrong with a rig as a whole: as a revision keeps it.
#pragma once

#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

struct Cause {
  std::string kind;                 // "board_size", ... (docs/api.md, causes); documents to come may know others
  std::string key;                  // alike on every robot that has it: the kind and what it is about (below)
  std::vector<SensorId> sensors;    // that it is about
  std::vector<TargetId> boards;     // likewise
  std::vector<CaptureId> captures;  // likewise: the first whose file cannot be read
  std::vector<EdgeId> edges;        // failed pairs that it explains; none: it failed no pair
  std::string why, what_to_do;      // a sentence each
  std::string command;              // to copy when that is done; empty: none
};

// Keys are words: "board_size panel larger", "board_unseen rear", "lens_model left fisheye_kb4"; of more than four
// sensors or boards the first four and "+N". Beside causes there are
inline constexpr const char* kFailedPairKey = "failed_pair";  // and two sensors by name: no cause explains it
inline constexpr const char* kMoreCausesKey = "more_causes";  // a robot has more than are kept by their keys

}  // namespace rigcal

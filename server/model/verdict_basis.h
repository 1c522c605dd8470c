// What a verdict rests on, for those who draw and count: the sentences themselves are for people.
#pragma once

#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

// The figure that decided, as a page shows it large: "Loop open by", "20 mm", "limit 1 mm: left, right and top".
struct DecidingFigure {
  std::string name, value, limit;  // name and value are empty together: no figure decided; `limit` may be empty
  friend bool operator==(const DecidingFigure&, const DecidingFigure&) = default;
};

// One of several reasons of a verdict, with what is done about it: sentences.
struct VerdictReason {
  std::string why, what_to_do;  // what_to_do may be empty: it is news, and asks for nothing
  friend bool operator==(const VerdictReason&, const VerdictReason&) = default;
};

// An edge that the rest of its graph checks in part only, or so roughly that an error of its tolerance would not show.
struct HardlyChecked {
  EdgeId edge;
  std::string what;  // "the height is not checked by anything else", of the edge's position or rotation, or both
  friend bool operator==(const HardlyChecked&, const HardlyChecked&) = default;
};

struct VerdictBasis {
  std::vector<SensorId> culprits = {};  // whom the first sentence accuses; empty: nobody by name, as of an open loop
  std::vector<SensorId> doubted = {};   // of an unknown one: who is not to be relied on; empty: nobody, or all
  DecidingFigure decided_by = {};
  std::vector<VerdictReason> reasons = {};         // where there are several: the verdict's sentences are all of them
  std::vector<HardlyChecked> hardly_checked = {};  // each edge once, whatever the verdict; as the edges stand
  [[nodiscard]] bool empty() const {
    return culprits.empty() && doubted.empty() && decided_by.name.empty() && reasons.empty() && hardly_checked.empty();
  }
  friend bool operator==(const VerdictBasis&, const VerdictBasis&) = default;
};

}  // namespace rigcal

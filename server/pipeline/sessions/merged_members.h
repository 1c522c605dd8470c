// READ: what a merged edge of a robot's newest revision stands for, for people who want to take some of it out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/edges/merged_edge.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct FoundMerged {
  RobotId robot;
  MergedEdge merged;
};
// By the id that it has in a robot's newest revision; `robot` where the store does not know whose it is, as that
// revision is from before ids were kept.
[[nodiscard]] Result<std::optional<FoundMerged>> FindMerged(storage::Store& store, const EdgeId& id,
                                                            const RobotId& robot);

// The edges that it stands for, the oldest first, without their block vectors; of a pair that has several merged edges
// those of all.
[[nodiscard]] Result<std::vector<Edge>> LoadWithin(storage::Store& store, const FoundMerged& found);
// What can be done in the place of taking out the merged edge whose id begins with `prefix`: kConflict, which names
// what it stands for. Good where there is none; `robot` may be empty.
[[nodiscard]] Status CheckIsNotMerged(storage::Store& store, const std::string& prefix, const RobotId& robot);
// The one of the robot whose id begins with `prefix`; kNotFound or kConflict says why there is not one.
[[nodiscard]] Result<FoundMerged> OnlyMerged(storage::Store& store, const std::string& prefix, const RobotId& robot);

}  // namespace rigcal::pipeline

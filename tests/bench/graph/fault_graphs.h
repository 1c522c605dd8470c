// Graphs of 12 sensors and 59 edges with known truth, and the faults that are put into them.
#pragma once

#include <set>

#include "server/graph/uncertainty/graph_jackknife.h"
#include "tests/unit/graph/random.h"

namespace rigcal::graph {

constexpr std::size_t kFaultSensors = 12, kFaultEdges = 59;

// How edges come to their information: it is known; by their own blocks, shrunk towards the model as sessions of ours
// are; by the plain scatter of blocks that nobody passed on; or by the blocks of one session of a camera rig, whose
// captures all edges share.
enum class Source { kKnown, kSessions, kScatter, kRig };
struct Information {
  Source source = Source::kKnown;
  int blocks = 0;
};

struct FaultGraph {
  RandomRig rig;
  BlocksByEdge blocks;
};

// 59 of the 66 pairs of 12 sensors within 1.5 m; an edge errs by 5 mm and 0.3 degrees.
[[nodiscard]] FaultGraph MakeFaultGraph(std::mt19937& random, const Information& information);
// `count` edges off by 10 cm and 10 degrees, each in a direction of its own.
std::set<EdgeId> SpoilEdges(RandomRig& rig, std::size_t count, std::mt19937& random);
// `count` edges of one sensor saw it 10 cm and 10 degrees elsewhere.
std::set<EdgeId> MoveSensor(RandomRig& rig, std::size_t sensor, std::size_t count, std::mt19937& random);

}  // namespace rigcal::graph

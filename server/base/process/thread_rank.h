// Who runs first where threads are more than processors: what answers before what takes in, both before what stores it,
// and that before what computes for long.
#pragma once

namespace rigcal {

enum class ThreadRank { kAnswers, kTakes, kServes, kStores, kWorks };

// Of the calling thread, and of every thread that it makes from now on. kStores and kWorks are for good: nobody may
// come back from them. Answering and taking run in real time (round robin, the two lowest priorities) where the process
// may: they do little at a time, and what they wait for is bounded by flow control. Where it may not, or the system
// does not know the difference, nothing changes.
void SetThreadRank(ThreadRank rank);

}  // namespace rigcal

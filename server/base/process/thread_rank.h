// Who runs first where threads are more than processors: what answers before what takes in, and both before what
// computes or writes for long.
#pragma once

namespace rigcal {

enum class ThreadRank { kAnswers, kTakes, kServes, kWorks };

// Of the calling thread, and of every thread that it makes from now on. kWorks is for good: nobody may come back from
// it. Answering and taking run in real time (round robin, the two lowest priorities) where the process
// may: they do little at a time, and what they wait for is bounded by flow control. Where it may not, or the system
// does not know the difference, nothing changes.
void SetThreadRank(ThreadRank rank);

}  // namespace rigcal

// What simulated rigs show of the sigmas, without rendering: rig_coverage WHAT [SEEDS [FIRST]] prints one JSON object.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/rig/rig_coverage.h"

namespace {

bool Print(const std::string& what, int seeds, int first) {
  using namespace rigcal;
  if (what == "coverage") return PrintCoverage(seeds, first), true;
  if (what == "motions") return PrintMotions(seeds, first), true;
  if (what == "given") return PrintGiven(seeds), true;
  if (what == "lidar_beams") return PrintLidarBeams(seeds), true;
  if (what == "turned") return PrintTurned(seeds), true;
  if (what == "same_bytes") return PrintSameBytes(seeds), true;
  if (what == "time") return PrintTime(), true;
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 1, first = argc > 3 ? std::atoi(argv[3]) : 1;
  std::printf("{");
  if (argc < 2 || seeds < 1 || !Print(argv[1], seeds, first)) {
    std::fprintf(stderr,
                 "usage: rig_coverage coverage|motions|given|lidar_beams|turned|same_bytes|time [SEEDS [FIRST]]\n");
    return 2;
  }
  std::printf("}\n");
  return 0;
}

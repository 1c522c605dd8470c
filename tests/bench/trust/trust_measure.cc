// What the service says of sessions whose assumptions do not hold, beside what is true: trust_measure SCENARIO
// [SESSIONS [FIRST]] prints one JSON object; trust_measure splits FOLDER those of real picture pairs.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "server/base/process/parallel_for.h"
#include "tests/bench/pairs/stereo_splits.h"
#include "tests/bench/trust/trust_json.h"
#include "tests/bench/trust/trust_scenarios.h"

namespace rigcal {
namespace {

int Usage() {
  std::fprintf(stderr, "usage: trust_measure SCENARIO [SESSIONS [FIRST]] | splits FOLDER\nscenarios:");
  for (const TrustScenario& scenario : TrustScenarios()) std::fprintf(stderr, " %s", scenario.name.c_str());
  std::fprintf(stderr, "\n");
  return 2;
}

void Measure(const TrustScenario& scenario, int sessions, int first) {
  std::vector<JudgedVisit> judged(static_cast<std::size_t>(sessions));
  ParallelFor(judged.size(),
              [&](std::size_t i) { judged[i] = JudgeVisit(scenario.visit(first + static_cast<int>(i))); });
  formats::JsonWriter out;
  out.Object([&] {
    out.Text("scenario", scenario.name);
    out.List("sessions", [&] {
      for (const JudgedVisit& one : judged) WriteJudged(one, out);
    });
  });
  std::printf("%s\n", out.Finish().c_str());
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  using namespace rigcal;
  if (argc < 2) return Usage();
  if (std::string(argv[1]) == "splits") return argc == 3 ? PrintSplits(argv[2]) : Usage();
  const int sessions = argc > 2 ? std::atoi(argv[2]) : 1, first = argc > 3 ? std::atoi(argv[3]) : 1;
  if (sessions < 1 || first < 1) return Usage();
  for (const TrustScenario& scenario : TrustScenarios())
    if (scenario.name == argv[1]) return Measure(scenario, sessions, first), 0;
  return Usage();
}

// What a fleet's visits find, against what happened to its robots; prints one JSON object.
// usage: fleet_measure ROBOTS WEEKS SEED BESIDE [reference-scatters|alone|alone-one-axis]   (BESIDE: FleetPlan::beside)
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/bench/fleet/drawn_fleet.h"

namespace rigcal::drawn_fleet {
namespace {

// Nothing where an argument is not what is asked for.
bool Read(int count, char** arguments, FleetPlan& plan) {
  const std::string_view how = count == 6 ? arguments[5] : "";
  if (count != 5 && how != "reference-scatters" && how != "alone" && how != "alone-one-axis") return false;
  plan.robots = std::atoi(arguments[1]);
  plan.weeks = std::atoi(arguments[2]);
  plan.seed = static_cast<unsigned>(std::atoi(arguments[3]));
  plan.beside = std::atoi(arguments[4]);
  plan.sizes.reference_scatters = how == "reference-scatters";
  plan.sizes.along_one_axis = how == "alone-one-axis";
  plan.alone = how == "alone" || how == "alone-one-axis";
  return plan.robots > 0 && plan.robots <= 100'000 && plan.weeks > 0 && plan.weeks <= 520 && plan.beside >= 0;
}

int Run(int count, char** arguments) {
  FleetPlan plan;
  if (!Read(count, arguments, plan)) {
    std::fprintf(stderr, "usage: fleet_measure ROBOTS WEEKS SEED BESIDE [reference-scatters|alone|alone-one-axis]\n");
    return 2;
  }
  const auto began = std::chrono::steady_clock::now();
  const FleetTally tally = RunFleet(plan);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("{\"robots\": %d, \"weeks\": %d, \"took_s\": %.3f, \"tally\": %s}\n", plan.robots, plan.weeks,
              took.count(), JsonOf(tally).c_str());
  return 0;
}

}  // namespace
}  // namespace rigcal::drawn_fleet

int main(int count, char** arguments) { return rigcal::drawn_fleet::Run(count, arguments); }

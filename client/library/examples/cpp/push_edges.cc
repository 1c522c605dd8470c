// Pushes pairwise results that this program made, and tells what the rig looks like with them: push_edges ROBOT
#include <rigcal/client.h>

#include <cstdio>

namespace {

// As if measured: b stands `x_m` in front of a, to 1 mm and 1 mrad in each axis.
rigcal::Edge InFront(const char* a, const char* b, double x_m) {
  rigcal::Matrix6 covariance{};
  for (std::size_t axis = 0; axis < 6; ++axis) covariance[axis][axis] = 1e-6;
  return {.frame_a = a,
          .frame_b = b,
          .T_a_b = {{x_m, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0}},
          .covariance = covariance,
          .dof = 12,
          .method = "ruler"};
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: push_edges ROBOT\n"), 2;
  rigcal::Client client;
  const std::array edges = {InFront("a", "b", 1.0), InFront("b", "c", 1.0), InFront("a", "c", 2.003)};
  const rigcal::PushResult pushed = client.PushEdges(argv[1], edges);
  std::printf("batch %s: %lld edges, %lld were there before\n", pushed.id.c_str(), static_cast<long long>(pushed.items),
              static_cast<long long>(pushed.held_before));
  std::printf("revision %lld: %s. %s\n", static_cast<long long>(pushed.standing.revision),
              pushed.standing.verdict.c_str(), pushed.standing.drive_rule.c_str());
  const rigcal::Lookup found = client.LookUp(argv[1], "b", "c", pushed.standing.revision);
  if (found.T_a_b)
    std::printf("c is %.4f m in front of b, sigma %.2f mm\n", found.T_a_b->pose.Matrix()[0][3],
                1e3 * std::sqrt(found.T_a_b->covariance[0][0]));
  return 0;
} catch (const rigcal::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

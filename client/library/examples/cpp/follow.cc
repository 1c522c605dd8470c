// On a robot: prints the calibration that it is to use, and anew at each change, COUNT times: follow ROBOT COUNT
#include <rigcal/client.h>

#include <cstdio>
#include <cstdlib>

namespace {

void Print(const rigcal::Calibration& calibration) {
  if (calibration.revision == 0) std::printf("no calibration is in use\n");
  for (const rigcal::SensorPose& row : calibration.sensors) {
    std::printf("revision %lld %s in %s", static_cast<long long>(calibration.revision), row.sensor.c_str(),
                calibration.reference.c_str());
    if (row.T_ref_sensor)
      for (const double value : row.T_ref_sensor->pose.p_m) std::printf(" %.6f", value);
    else
      std::printf(" not known whole");
    std::printf("\n");
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: follow ROBOT COUNT\n"), 2;
  try {
    rigcal::Client client;
    rigcal::Follower follower = client.Follow(argv[1]);
    for (int left = std::atoi(argv[2]); left > 0;) try {
        if (const auto calibration = follower.Next(60.0)) {
          Print(*calibration);
          --left;
        }
      } catch (const rigcal::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());  // what was told last still holds
        if (error.code() != rigcal::Code::kUnreachable) return 1;
      }
  } catch (const rigcal::Error& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
  }
  return 0;
}

// Sends a session folder and waits for its calibration: push_session FOLDER. Break it off and run it again when you
// like.
#include <rigcal/client.h>

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: push_session FOLDER\n"), 2;
  rigcal::Client client;
  const rigcal::PushResult pushed = client.PushSession(argv[1]);
  std::printf("session %s: %lld files\n", pushed.id.c_str(), static_cast<long long>(pushed.items));
  std::printf("revision %lld: %s. %s\n", static_cast<long long>(pushed.standing.revision),
              pushed.standing.verdict.c_str(), pushed.standing.drive_rule.c_str());
  return 0;
} catch (const rigcal::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

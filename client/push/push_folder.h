// A session folder on its way to the server and back as poses, whoever made the folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/verb.h"

namespace rigcal::client {

// How a bag becomes a session folder first.
struct BagChoice {
  std::string rig, work;                  // rig.yaml; where the folder is made (empty: beside the bag)
  double every_s = -1, tolerance_s = -1;  // negative: as rig.yaml says
  // Whether anything of it is given.
  [[nodiscard]] bool IsGiven() const { return !rig.empty() || !work.empty() || every_s >= 0 || tolerance_s >= 0; }
};

struct PushOptions {
  std::string folder;  // or the bag
  BagChoice bag;
  double give_up_s = 60.0;
  std::optional<std::uint64_t> shuffle_seed;
  bool no_wait = false, new_robot = false;
  std::vector<std::string> remounted;
};

// Sends the folder, waits for its result and prints it, as `options` say; sets the context's exit code. The error is
// that of the folder, the connection or the server; it is not printed.
[[nodiscard]] Status PushFolder(Context& context, const PushOptions& options);

}  // namespace rigcal::client

// Finished edges on their way to the server and back as poses, wherever they were read.
#pragma once

#include <string>

#include "client/verb.h"
#include "client/wire/edge_outlet.h"

namespace rigcal::client {

struct BatchOptions {
  std::string origin;  // of the edges, named in errors: a file
  double give_up_s = 60.0;
  bool no_wait = false, new_robot = false;
};

// Sends the batch, waits for its result and prints it, as `options` say; sets the context's exit code. The error is
// that of the batch, the connection or the server; it is not printed.
[[nodiscard]] Status PushBatch(Context& context, const BatchOptions& options, const EdgesToPush& batch);

}  // namespace rigcal::client

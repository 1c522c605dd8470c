// A robot's graph of measurements as a g2o file: not a calibration, so nobody has to have approved it.
#pragma once

#include <string>

#include "client/verb.h"

namespace rigcal::client {

struct GraphExport {
  std::string robot, file;
  int revision = 0;  // 0: the newest
};
// Writes it, and says what is in it; the code to exit with.
ExitCode ExportGraph(const Context& context, const GraphExport& wanted);

}  // namespace rigcal::client

// How the program ends, and the one sentence for an error.
#pragma once

#include <ostream>

#include "server/base/result.h"

namespace rigcal::client {

enum class ExitCode {
  kGood = 0,
  kVerdictFail = 1,  // the answer came and says "fail" (a robot's verdict, an overdue robot, a failed check)
  kUsage = 2,
  kUnreachable = 3,
  kRefused = 4,  // the input, or the thing asked for, was refused
};

[[nodiscard]] ExitCode ExitCodeOf(const Error& error);
// Prints "rigcal: <what>. <cure>" and gives the code to exit with.
ExitCode Report(const Error& error, std::ostream& err);

}  // namespace rigcal::client

// How the program ends, and the one sentence for an error.
#pragma once

#include <ostream>

#include "server/base/result.h"

namespace rigcal::client {

enum class ExitCode {
  kGood = 0,
  kVerdictFail = 1,  // the answer came and says "fail" (a robot's verdict, a robot that is due, a failed check)
  kUsage = 2,
  kUnreachable = 3,
  kRefused = 4,         // the input, or the thing asked for, was refused
  kVerdictWarn = 5,     // the answer came and says "warn"
  kVerdictUnknown = 6,  // the answer came, and nothing is known: no result, no verdict, or not of what the robot runs
};

// kUnreachable stays; every other error is kRefused.
[[nodiscard]] ExitCode ExitCodeOf(const Error& error);
// Prints "rigcal: <what>. <cure>" and gives the code to exit with.
ExitCode Report(const Error& error, std::ostream& err);

}  // namespace rigcal::client

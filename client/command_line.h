// The whole command line: parses, runs one verb, gives the exit code. No exception leaves it.
// `rigcal simulate` and `rigcal check` replace the process.
#pragma once

#include <ostream>
#include <span>

#include "client/verbs.h"

namespace rigcal::client {

// One command, `argv` as of main: what it gives goes to `out`, what is wrong to `err`. The exit code (exit_code.h);
// never throws.
int RunCommandLine(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal);
// With these verbs only.
int RunCommandLine(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal,
                   std::span<const AddVerb> verbs);

}  // namespace rigcal::client

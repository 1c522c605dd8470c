// The whole command line: parses, runs one verb, gives the exit code. No exception leaves it.
#pragma once

#include <ostream>

namespace rigcal::client {

int RunCommandLine(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal);

}  // namespace rigcal::client

// A password from whoever is at the terminal, without showing it, or from a program that writes it to standard input.
#pragma once

#include <ostream>
#include <string>

#include "server/base/result.h"

namespace rigcal::client {

// On a terminal asked for twice, by way of `err`; else the first line of standard input. kInvalidInput where it was not
// typed alike twice, is none (base/digests/password.h), or nothing came.
[[nodiscard]] Result<std::string> AskPassword(const std::string& of_whom, std::ostream& err);

}  // namespace rigcal::client

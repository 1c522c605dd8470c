// Names of people on the command line.
#pragma once

#include <CLI/CLI.hpp>

namespace rigcal::client {

// Refuses a name of nothing but blanks: who left it out is known by another name, who gave none is nobody.
[[nodiscard]] const CLI::Validator& Named();

}  // namespace rigcal::client

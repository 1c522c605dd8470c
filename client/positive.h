// Numbers on the command line that count from 1, or are more than 0.
#pragma once

#include <CLI/CLI.hpp>

namespace rigcal::client {

// Refuses 0, what is less, and what is no number, in words: "0 is out of range: give a number above 0". In the help of
// an option it stands as "POSITIVE".
[[nodiscard]] const CLI::Validator& Positive();

}  // namespace rigcal::client

// Real picture pairs, leftNN.jpg and rightNN.jpg of a board of 9 x 6 inner corners of 25 mm, as a problem.
#pragma once

#include <filesystem>

#include "server/calib/stereo/stereo.h"

namespace rigcal {

// Every pair of the folder, its boards found.
[[nodiscard]] calib::StereoProblem StereoProblemOf(const std::filesystem::path& folder);

}  // namespace rigcal

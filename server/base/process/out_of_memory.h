// Whether what a library threw means that there was no memory: then nothing is known of the input, and the work is to
// be done again.
#pragma once

#include <exception>

namespace rigcal {

// std::bad_alloc, no memory for a thread, and OpenCV's "Insufficient memory".
[[nodiscard]] bool IsOutOfMemory(const std::exception& exception);

}  // namespace rigcal

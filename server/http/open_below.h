// Opens files below a folder and nowhere else: neither a symbolic link nor ".." leads out, also where somebody changes
// the folder meanwhile.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/files/file_descriptor.h"

namespace rigcal::http {

// `file`, relative to `folder`, for reading, without waiting where it is a pipe; negative where there is none, a link
// stands in the way, `file` is empty, absolute or has "." or "..", or `folder` is empty.
[[nodiscard]] FileDescriptor OpenBelow(const std::filesystem::path& folder, const std::string& file);
// The same, folder by folder: what OpenBelow does where the kernel has no openat2() or a sandbox refuses it.
[[nodiscard]] FileDescriptor OpenStepwiseBelow(const std::filesystem::path& folder, const std::string& file);

}  // namespace rigcal::http

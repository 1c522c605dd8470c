// Whether what is to be pushed is a bag, and where it becomes a session folder.
#pragma once

#include <filesystem>

namespace rigcal::client {

// A file; or a folder without session.yaml that has a bag's metadata.yaml or files in it.
[[nodiscard]] bool IsBagPath(const std::filesystem::path& path);
// "drive.mcap.rigcal-push" beside the bag, or in `work` where that is not empty. The same bag, the same folder.
[[nodiscard]] std::filesystem::path PushFolderOf(const std::filesystem::path& bag, const std::filesystem::path& work);

}  // namespace rigcal::client

// Files that nobody else on the machine may read: passwords' hashes, pictures, who decided what.
#pragma once

#include <filesystem>
#include <string>

namespace rigcal {

// What this process and its children make from now on is for its user alone: folders 0700, files 0600.
void MakePrivateFiles();
// Whether users of this machine besides its owner and group can read or enter the folder; false where there is none.
[[nodiscard]] bool IsOpenToOthers(const std::filesystem::path& folder);
// "others on this machine can read the folder /srv/rigcal: `chmod -R o= /srv/rigcal` ends that".
[[nodiscard]] std::string OpenFolderText(const std::filesystem::path& folder);

}  // namespace rigcal

#include "server/base/files/private_files.h"

#include <sys/stat.h>

namespace rigcal {

void MakePrivateFiles() { ::umask(S_IRWXG | S_IRWXO); }

bool IsOpenToOthers(const std::filesystem::path& folder) {
  struct stat status {};
  return ::stat(folder.c_str(), &status) == 0 && (status.st_mode & S_IRWXO) != 0;
}

std::string OpenFolderText(const std::filesystem::path& folder) {
  return "others on this machine can read the folder " + folder.string() + ": `chmod -R o= " + folder.string() +
         "` ends that";
}

}  // namespace rigcal

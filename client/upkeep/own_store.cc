#include "client/upkeep/own_store.h"

#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <ostream>

#include "client/change/order.h"
#include "server/base/files/private_files.h"
#include "storage/upkeep/open_unchanged.h"

namespace rigcal::client {
namespace {

std::string NameOfUser(uid_t user) {
  const passwd* const known = getpwuid(user);
  return known == nullptr ? "#" + std::to_string(user) : known->pw_name;
}

}  // namespace

Status CheckOwner(const std::string& folder) {
  struct stat status {};
  if (stat(folder.c_str(), &status) != 0 || status.st_uid == geteuid()) return {};
  const std::string owner = NameOfUser(status.st_uid);
  return Fail(ErrorCode::kConflict,
              folder + " belongs to user " + owner + ", and this is " + NameOfUser(geteuid()) +
                  ": what it writes there could keep the rigcald out",
              "Write `sudo -u " + owner + " rigcal ...`.");
}

Result<storage::Store> OpenOwnStore(const std::string& folder, std::ostream& err) {
  MakePrivateFiles();
  RIGCAL_TRY(CheckOwner(folder));
  if (const char* rows = std::getenv("RIGCAL_STORE"); rows != nullptr && *rows != 0) {
    RIGCAL_ASSIGN(const storage::StorePlace place, storage::StorePlaceOf(rows, folder));
    if (!place.server.empty()) return storage::Store::Open(place);
  }
  auto opened = storage::OpenUnchanged(folder);
  if (opened || opened.error().code != ErrorCode::kNotFound) return opened;
  auto made = storage::Store::Open(std::filesystem::path(folder));
  if (made)
    err << "There was no store in " << folder
        << ": a new one was made. If a rigcald serves another folder, give that one as --data." << std::endl;
  return made;
}

Word WordOf(const std::string& given) {
  const char* const called = std::getenv("SUDO_USER");
  return {SystemClock().Now(), !given.empty() ? given : called != nullptr && *called != 0 ? called : LoginName(), ""};
}

}  // namespace rigcal::client

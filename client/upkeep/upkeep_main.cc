// What `rigcal backup`, `restore-backup`, `fsck`, `migrate-store`, `user`, `token`, `identity` and `support-bundle`
// start: takes the same words, and has these verbs only.
#include <unistd.h>

#include <iostream>

#include "client/command_line.h"

int main(int argc, char** argv) {
  const rigcal::client::AddVerb verbs[] = {rigcal::client::AddBackup,        rigcal::client::AddRestoreBackup,
                                           rigcal::client::AddFsck,          rigcal::client::AddUser,
                                           rigcal::client::AddToken,         rigcal::client::AddIdentity,
                                           rigcal::client::AddSupportBundle, rigcal::client::AddMigrateStore};
  return rigcal::client::RunCommandLine(argc, argv, std::cout, std::cerr, isatty(STDERR_FILENO) == 1, verbs);
}

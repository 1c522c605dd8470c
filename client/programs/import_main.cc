// What `rigcal import` starts, `rigcal record`, `rigcal replay`, and `rigcal push` of a bag: takes the same words, and
// has those verbs only.
#include <unistd.h>

#include <iostream>

#include "client/command_line.h"
#include "client/programs/push_bag.h"

int main(int argc, char** argv) {
  const rigcal::client::AddVerb verbs[] = {rigcal::client::AddImport, rigcal::client::AddPushOfBags,
                                           rigcal::client::AddRecord, rigcal::client::AddReplay};
  return rigcal::client::RunCommandLine(argc, argv, std::cout, std::cerr, isatty(STDERR_FILENO) == 1, verbs);
}

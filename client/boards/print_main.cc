// What `rigcal board print` and `rigcal certificate` start: takes the same words, and draws.
#include <unistd.h>

#include <iostream>

#include "client/command_line.h"

int main(int argc, char** argv) {
  const rigcal::client::AddVerb verbs[] = {rigcal::client::AddBoardPrint, rigcal::client::AddCertificate};
  return rigcal::client::RunCommandLine(argc, argv, std::cout, std::cerr, isatty(STDERR_FILENO) == 1, verbs);
}

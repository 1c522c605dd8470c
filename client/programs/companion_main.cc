// What `rigcal companion` starts: takes the same words, and has that verb only.
#include <unistd.h>

#include <iostream>

#include "client/command_line.h"

int main(int argc, char** argv) {
  const rigcal::client::AddVerb verbs[] = {rigcal::client::AddCompanion};
  return rigcal::client::RunCommandLine(argc, argv, std::cout, std::cerr, isatty(STDERR_FILENO) == 1, verbs);
}

// Runs the whole command line in the test's process, against a FakeServer.
#pragma once

#include <sstream>

#include "client/command_line.h"
#include "tests/unit/client/fake_server.h"

namespace rigcal::client {

struct Ran {
  int code = -1;
  std::string out, err;
};

inline Ran Rigcal(std::vector<std::string> words) {
  words.insert(words.begin(), "rigcal");
  words.insert(words.end(), {"--tag", TestPlace().tag, "--timeout", "20"});
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out, err;
  const int code = RunCommandLine(static_cast<int>(argv.size()), argv.data(), out, err, false);
  return {code, out.str(), err.str()};
}

inline FakeServer::AnswerTo Always(const std::string& text) {
  return [text](const std::string&, const std::string&) -> Result<std::string> { return text; };
}

}  // namespace rigcal::client

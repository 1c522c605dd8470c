// What may stand next on a command line that is being typed. Pure: names of robots and sensors are left to whoever
// asks.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rigcal::client {

struct NextWord {
  enum class Kind { kWords, kFiles, kFolders, kRobots, kSensors, kOfOtherProgram };
  struct Candidate {
    std::string word, meaning;
  };
  Kind kind = Kind::kWords;
  std::string typed;                         // how the word begins, maybe empty
  std::vector<Candidate> candidates;         // of kWords: those that begin so
  std::string subject;                       // of kSensors the robot, of kOfOtherProgram its verb
  std::map<std::string, std::string> given;  // options with a value so far, by name without dashes
};

// `words`: those after the program's name, of which the last is not finished. One that is "=" stands for none, as bash
// takes --name=value apart.
[[nodiscard]] NextWord NextWordOf(const CLI::App& app, std::span<const std::string> words);

}  // namespace rigcal::client

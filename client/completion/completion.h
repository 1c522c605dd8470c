// What the shells' completion scripts ask: the hidden `rigcal complete-words -- WORDS`.
#pragma once

#include <string>
#include <vector>

#include "client/verb.h"

namespace CLI {
class App;
}

namespace rigcal::client {

// Whether the command line is a shell's question what may stand there.
[[nodiscard]] bool AsksForCompletion(const Context& context);
// Prints what may stand in place of the last of WORDS, one a line: the word, a tab, its meaning. Files are left to the
// shell by the line ":files", folders by ":folders". Robots and sensors are asked from the server; where it does not
// answer at once there are none. Says nothing of failures.
void CompleteWords(const CLI::App& app, Context& context);

}  // namespace rigcal::client

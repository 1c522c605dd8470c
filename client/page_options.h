// Options of the verbs that list a history by pages.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "client/text/document.h"

namespace CLI {
class App;
}

namespace rigcal::client {

struct PageOptions {
  int limit = 0;       // 0: not asked for
  std::string before;  // of docs/api.md; empty: likewise
};
// --limit and --before; `rows` and `cursor` are for the help: "sessions", "the id of a session".
void AddPageOptions(CLI::App& verb, PageOptions& options, const std::string& rows, const std::string& cursor);
void AddTo(std::vector<Field>& parameters, const PageOptions& options);
// How to ask for the next page, where the document names one; `command` without --before: "rigcal sessions --limit 20".
void PrintNextPage(const Document& document, const std::string& command, std::ostream& out);
inline constexpr const char* kNoOlderOnes = "There are no older ones.\n";
[[nodiscard]] std::string LimitText(const PageOptions& options);  // " --limit 20", or nothing

}  // namespace rigcal::client

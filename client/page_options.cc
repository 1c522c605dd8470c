#include "client/page_options.h"

#include <CLI/CLI.hpp>

#include "client/text/table.h"
#include "server/base/limits.h"

namespace rigcal::client {

void AddPageOptions(CLI::App& verb, PageOptions& options, const std::string& rows, const std::string& cursor) {
  verb.add_option("--limit", options.limit, "Only so many " + rows + ", the newest first")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{1}, limits::kPageRowsMax));
  verb.add_option("--before", options.before, "Only those after this one in the list: " + cursor)->type_name("ID");
}

void AddTo(std::vector<Field>& parameters, const PageOptions& options) {
  if (options.limit > 0) parameters.emplace_back("limit", std::int64_t{options.limit});
  if (!options.before.empty()) parameters.emplace_back("before", options.before);
}

void PrintNextPage(const Document& document, const std::string& command, std::ostream& out) {
  const Document next = document["next"];
  const auto number = next.Integer();
  const std::string cursor = number ? std::to_string(*number) : Plain(next.Text());
  if (!cursor.empty()) out << "There are older ones: `" << command << " --before " << cursor << "`\n";
}

std::string LimitText(const PageOptions& options) {
  return options.limit > 0 ? " --limit " + std::to_string(options.limit) : "";
}

}  // namespace rigcal::client

// The verbs and options that a command line has, as CLI11 knows them.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rigcal::client {

// In the order of --help.
[[nodiscard]] std::vector<const CLI::App*> VerbsOf(const CLI::App& app);
// Also those of its groups; the positional ones too.
[[nodiscard]] std::vector<const CLI::Option*> OptionsOf(const CLI::App& app);

// Of a command line that `app` could not parse: "there is no verb 'pusch': did you mean push?". Empty where it has
// every verb and option that was named.
[[nodiscard]] std::string UnknownWordText(const CLI::App& app);

}  // namespace rigcal::client

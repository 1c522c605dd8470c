#include "client/completion/command_words.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "client/text/table.h"
#include "server/base/near_names.h"

namespace rigcal::client {
namespace {

using Words = std::vector<std::string>;

Words LongNamesOf(const CLI::App& app) {
  Words names;
  for (const CLI::Option* option : OptionsOf(app))
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

Words NearestVerbs(const std::string& word, const CLI::App& app) {
  Words verbs;
  for (const CLI::App* verb : VerbsOf(app)) verbs.push_back(verb->get_name());
  return NearestNames(word, verbs);
}

// `word`: --name, or --name=value.
std::string OptionText(const std::string& word, const CLI::App& app) {
  const std::string name = word.substr(0, word.find('='));
  Words known = LongNamesOf(app);
  for (const CLI::App* verb : app.get_subcommands())
    for (std::string& one : LongNamesOf(*verb)) known.push_back(std::move(one));
  Words nearest = NearestNames(name.substr(name.find_first_not_of('-')), known);
  for (std::string& one : nearest) one.insert(0, "--");
  return "there is no option '" + Plain(name) + "'" + Suggestion(nearest);
}

bool IsOptionWord(const std::string& word) {
  return word.rfind('-', 0) == 0 && word.find_first_not_of('-') != std::string::npos;
}

}  // namespace

std::vector<const CLI::App*> VerbsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* one) { return !one->get_name().empty(); });
}

std::vector<const CLI::Option*> OptionsOf(const CLI::App& app) {
  std::vector<const CLI::Option*> options = app.get_options();
  for (const CLI::App* group : app.get_subcommands([](const CLI::App* one) { return one->get_name().empty(); }))
    for (const CLI::Option* option : OptionsOf(*group)) options.push_back(option);
  return options;
}

std::string UnknownWordText(const CLI::App& app) {
  const Words left = app.remaining();
  const bool has_verb = !app.get_subcommands().empty();
  const auto option = std::find_if(left.begin(), left.end(), IsOptionWord);
  auto word = left.end();
  if (!has_verb)
    word =
        std::find_if(left.begin(), left.end(), [&](const std::string& one) { return !NearestVerbs(one, app).empty(); });
  // The options of a verb that is not known are not known either.
  if (word == left.end() && !has_verb && option != left.begin()) word = left.begin();
  if (word != left.end()) return "there is no verb '" + Plain(*word) + "'" + Suggestion(NearestVerbs(*word, app));
  return option != left.end() ? OptionText(*option, app) : "";
}

}  // namespace rigcal::client

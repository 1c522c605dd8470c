#include "client/completion/completion.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "client/completion/next_word.h"
#include "client/elsewhere.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "completion_scripts.h"

namespace rigcal::client {
namespace {

constexpr std::string_view kCompleteWords = "complete-words";
constexpr std::chrono::milliseconds kNamesWithin(500);  // while somebody waits for a key to act
constexpr double kTimeoutMax_s = 86'400.0;

std::vector<std::string> TypedWordsOf(const Context& context) {
  std::vector<std::string> words(context.arguments.begin() + 2, context.arguments.end());
  if (!words.empty() && words.front() == "--") words.erase(words.begin());
  return words;
}

// As `--tag`, `--domain` and `--timeout` of the line have it.
void GoWhereTheLineGoes(const NextWord& next, Context& context) {
  const auto given = [&](const char* option) {
    const auto found = next.given.find(option);
    return found == next.given.end() ? std::string() : found->second;
  };
  context.dds.tag = given("tag");
  if (const std::string domain = given("domain"); !domain.empty()) setenv("RIGCAL_DOMAIN", domain.c_str(), 1);
  const double timeout_s = std::strtod(given("timeout").c_str(), nullptr);
  context.timeout = kNamesWithin;
  if (timeout_s > 0.0 && timeout_s <= kTimeoutMax_s)
    context.timeout = std::chrono::milliseconds(std::llround(timeout_s * 1e3));
}

void PrintNames(const NextWord& next, const std::string& verb, const std::string& key, Context& context) {
  GoWhereTheLineGoes(next, context);
  std::vector<Field> parameters;
  if (!next.subject.empty()) parameters.emplace_back("robot", next.subject);
  if (!next.typed.empty()) parameters.emplace_back("prefix", next.typed);
  const auto text = AskOnce(context, verb, JsonObject(parameters));
  if (!text) return;
  const auto names = Document::Parse(*text, verb);
  if (!names) return;
  for (const Document& name : (*names)[key].Items()) context.out << Plain(name.Text()) << '\n';
}

std::string_view ScriptOf(const std::string& shell) {
  if (shell == "zsh") return scripts::k_rigcal;
  return shell == "fish" ? scripts::krigcal_fish : scripts::krigcal_bash;
}

}  // namespace

bool AsksForCompletion(const Context& context) {
  return context.arguments.size() > 1 && context.arguments[1] == kCompleteWords;
}

void CompleteWords(const CLI::App& app, Context& context) {
  const NextWord next = NextWordOf(app, TypedWordsOf(context));
  switch (next.kind) {
    case NextWord::Kind::kWords:
      for (const auto& [word, meaning] : next.candidates) context.out << word << '\t' << meaning << '\n';
      break;
    case NextWord::Kind::kFiles:
      context.out << ":files\n";
      break;
    case NextWord::Kind::kFolders:
      context.out << ":folders\n";
      break;
    case NextWord::Kind::kRobots:
      return PrintNames(next, "robot_names", "robots", context);
    case NextWord::Kind::kSensors:
      return PrintNames(next, "sensor_names", "sensors", context);
    case NextWord::Kind::kOfOtherProgram:
      (void)StartElsewhere(context, ProgramOf(next.subject));
  }
}

void AddCompletion(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("completion", "Print the script by which a shell completes what is typed");
  auto shell = std::make_shared<std::string>();
  verb->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(kShells.begin(), kShells.end())));
  verb->footer(
      "Verbs, options, files, and the server's robots and sensors. The Debian package installs the scripts.\n"
      "Examples:\n"
      "  rigcal completion bash > ~/.local/share/bash-completion/completions/rigcal\n"
      "  rigcal completion zsh > ~/.zfunc/_rigcal      with fpath+=(~/.zfunc) before compinit in ~/.zshrc\n"
      "  rigcal completion fish > ~/.config/fish/completions/rigcal.fish\n");
  verb->callback([&context, shell] { context.out << ScriptOf(*shell) << std::flush; });
}

}  // namespace rigcal::client

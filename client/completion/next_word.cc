#include "client/completion/next_word.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>

#include "client/completion/command_words.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

bool TakesValue(const CLI::Option& option) { return option.get_items_expected_min() > 0; }

bool LooksLikeOption(const std::string& word) { return word.size() > 1 && word.front() == '-'; }

std::string LongName(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : option.get_lnames().front();
}

// "ROBOT", "FILE.zip": what a word is, as --help calls it.
std::string KindText(const CLI::Option& option) {
  return option.get_positional() ? option.get_name(true) : option.get_type_name();
}

// The finished words, taken one by one.
class TypedWords {
 public:
  explicit TypedWords(const CLI::App& app) : app_(app) {}

  void Take(const std::string& word) {
    if (word == "=") return;
    if (pending_ != nullptr) return TakeValue(word);
    if (!only_positional_ && LooksLikeOption(word)) return TakeOption(word);
    if (verb_ != nullptr) return positional_.push_back(word);
    for (const CLI::App* verb : VerbsOf(app_))
      if (verb->get_name() == word) verb_ = verb;
    is_lost_ = verb_ == nullptr;
  }

  [[nodiscard]] NextWord Next(const std::string& typed) const {
    NextWord next;
    next.typed = typed;
    next.given = given_;
    if (is_lost_) return next;
    if (verb_ != nullptr && verb_->get_prefix_command()) {
      next.kind = NextWord::Kind::kOfOtherProgram;
      next.subject = verb_->get_name();
    } else if (pending_ != nullptr) {
      AddValues(*pending_, next);
    } else if (!only_positional_ && typed.rfind('-', 0) == 0) {
      AddOptions(next);
    } else if (verb_ == nullptr) {
      for (const CLI::App* verb : VerbsOf(app_)) Add(verb->get_name(), verb->get_description(), next);
    } else {
      AddPositional(next);
    }
    return next;
  }

 private:
  static void Add(const std::string& word, const std::string& meaning, NextWord& next) {
    if (word.rfind(next.typed, 0) == 0) next.candidates.push_back({word, meaning});
  }

  [[nodiscard]] std::vector<const CLI::Option*> Options() const {
    std::vector<const CLI::Option*> options = verb_ == nullptr ? std::vector<const CLI::Option*>() : OptionsOf(*verb_);
    for (const CLI::Option* option : OptionsOf(app_)) options.push_back(option);
    return options;
  }

  void TakeOption(const std::string& word) {
    only_positional_ = word == "--";
    const std::size_t equals = word.find('=');
    const auto options = Options();
    const auto option = std::find_if(options.begin(), options.end(),
                                     [&](const CLI::Option* one) { return one->check_name(word.substr(0, equals)); });
    if (option == options.end() || !TakesValue(**option)) return;
    pending_ = *option;
    if (equals != std::string::npos) TakeValue(word.substr(equals + 1));
  }

  void TakeValue(const std::string& value) {
    given_[LongName(*pending_)] = value;
    pending_ = nullptr;
  }

  void AddOptions(NextWord& next) const {
    std::set<std::string> told;
    for (const CLI::Option* option : Options())
      for (const std::string& name : option->get_lnames())
        if (!option->get_group().empty() && told.insert(name).second) Add("--" + name, option->get_description(), next);
  }

  void AddPositional(NextWord& next) const {
    std::size_t before = positional_.size();
    for (const CLI::Option* option : OptionsOf(*verb_))
      if (option->get_positional() && before-- == 0) return AddValues(*option, next);
  }

  void AddActions(NextWord& next) const {
    const std::string verb = verb_ == nullptr ? "" : verb_->get_name();
    if (verb == "board")
      for (const char* action : kBoardActions) Add(action, "", next);
    if (verb == "model")
      for (const char* action : kModelActions) Add(action, "", next);
    if (verb == "policy")
      for (const char* action : kPolicyActions) Add(action, "", next);
  }

  void AddValues(const CLI::Option& option, NextWord& next) const {
    const std::string kind = KindText(option);
    if (kind == "ROBOT" || LongName(option) == "robot") next.kind = NextWord::Kind::kRobots;
    if (kind.rfind("FILE", 0) == 0 || kind == "RIG" || kind == "BAG" || kind == "PATH")
      next.kind = NextWord::Kind::kFiles;
    if (kind == "DIR" || kind == "FROM" || kind == "TO") next.kind = NextWord::Kind::kFolders;
    if (kind == "SHELL")
      for (const char* shell : kShells) Add(shell, "", next);
    const bool of_model = verb_ != nullptr && verb_->get_name() == "model";
    if (kind == "ACTION") AddActions(next);
    const bool is_shown = !positional_.empty() && positional_.front() == "show";
    if (kind == "WHAT" && !positional_.empty() && !is_shown) next.kind = NextWord::Kind::kFiles;
    if (kind == "WHAT" && is_shown && !of_model) next.kind = NextWord::Kind::kRobots;
    if (kind == "A" || kind == "B" || LongName(option) == "sensor" || LongName(option) == "root")
      AddSensors(positional_.empty() ? "" : positional_.front(), next);
    if (kind == "THING")
      if (const auto robot = given_.find("robot"); robot != given_.end()) AddSensors(robot->second, next);
  }

  static void AddSensors(const std::string& robot, NextWord& next) {
    if (robot.empty()) return;
    next.kind = NextWord::Kind::kSensors;
    next.subject = robot;
  }

  const CLI::App& app_;
  const CLI::App* verb_ = nullptr;
  const CLI::Option* pending_ = nullptr;  // its value comes next
  std::vector<std::string> positional_;
  std::map<std::string, std::string> given_;
  bool only_positional_ = false, is_lost_ = false;  // lost: there is no such verb
};

}  // namespace

NextWord NextWordOf(const CLI::App& app, std::span<const std::string> words) {
  TypedWords typed(app);
  if (words.empty()) return typed.Next("");
  for (const std::string& word : words.first(words.size() - 1)) typed.Take(word);
  return typed.Next(words.back() == "=" ? "" : words.back());
}

}  // namespace rigcal::client

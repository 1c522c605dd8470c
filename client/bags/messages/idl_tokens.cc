#include "client/bags/messages/idl_tokens.h"

#include <cctype>

namespace rigcal::bags {
namespace {

constexpr const char* kCure = "Record the topic again with its right definition.";

tl::unexpected<Error> Bad(std::string what) { return Fail(ErrorCode::kInvalidInput, std::move(what), kCure); }

bool IsNameChar(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  // Nothing at the end: an empty token.
  Result<std::string_view> Next() {
    for (;;) {
      SkipBlanks();
      if (rest_.empty()) return std::string_view();
      if (rest_.rfind("//", 0) == 0 || (line_begins_ && IsNoIdl())) {
        rest_.remove_prefix(std::min(rest_.size(), rest_.find('\n')));
      } else if (rest_.rfind("/*", 0) == 0) {
        const std::size_t end = rest_.find("*/", 2);
        if (end == std::string_view::npos) return Bad("the IDL has a comment without an end");
        rest_.remove_prefix(end + 2);
      } else {
        return Token();
      }
    }
  }

 private:
  void SkipBlanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0) {
      line_begins_ = line_begins_ || rest_.front() == '\n';
      rest_.remove_prefix(1);
    }
  }
  [[nodiscard]] bool IsNoIdl() const {
    return rest_[0] == '#' || rest_.rfind("===", 0) == 0 || rest_.rfind("IDL:", 0) == 0;
  }

  Result<std::string_view> Token() {
    line_begins_ = false;
    if (rest_[0] == '"' || rest_[0] == '\'') return Text();
    std::size_t size = 0;
    while (size < rest_.size() && (IsNameChar(rest_[size]) || rest_.substr(size, 2) == "::"))
      size += rest_[size] == ':' ? 2 : 1;
    return Take(size == 0 ? 1 : size);
  }

  Result<std::string_view> Text() {
    std::size_t end = 1;
    while (end < rest_.size() && rest_[end] != rest_[0]) end += rest_[end] == '\\' ? 2 : 1;
    if (end >= rest_.size()) return Bad("the IDL has a text without an end");
    return Take(end + 1);
  }
  std::string_view Take(std::size_t size) {
    const std::string_view token = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return token;
  }

  std::string_view rest_;
  bool line_begins_ = true;
};

}  // namespace

Result<std::vector<std::string_view>> IdlTokens(std::string_view text) {
  std::vector<std::string_view> tokens;
  Scanner scanner(text);
  int depth = 0;  // of the parentheses behind an annotation
  bool was_annotation = false;
  for (;;) {
    RIGCAL_ASSIGN(const std::string_view token, scanner.Next());
    if (token.empty()) break;
    if (depth > 0 || (was_annotation && token == "(")) {
      depth += token == "(" ? 1 : token == ")" ? -1 : 0;
      was_annotation = false;
    } else if (token == "@") {
      RIGCAL_TRY(scanner.Next());  // its name
      was_annotation = true;
    } else {
      was_annotation = false;
      tokens.push_back(token);
    }
  }
  return tokens;
}

}  // namespace rigcal::bags

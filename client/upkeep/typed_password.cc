#include "client/upkeep/typed_password.h"

#include <termios.h>
#include <unistd.h>

#include <iostream>

#include "server/base/digests/password.h"

namespace rigcal::client {
namespace {

// What is typed meanwhile is not shown; a signal in between leaves the terminal to the shell, which puts it right.
class Unseen {
 public:
  Unseen() {
    has_terminal_ = tcgetattr(STDIN_FILENO, &before_) == 0;
    termios unseen = before_;
    unseen.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    if (has_terminal_) tcsetattr(STDIN_FILENO, TCSAFLUSH, &unseen);
  }
  ~Unseen() {
    if (has_terminal_) tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
  }
  Unseen(const Unseen&) = delete;
  Unseen& operator=(const Unseen&) = delete;

 private:
  termios before_{};
  bool has_terminal_ = false;
};

Result<std::string> ReadLine() {
  std::string line;
  if (!std::getline(std::cin, line))
    return Fail(ErrorCode::kInvalidInput, "no password came on standard input",
                "Type it, or write it there as one line.");
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

Result<std::string> TypedOnce(const std::string& question, std::ostream& err) {
  const Unseen unseen;
  err << question << std::flush;
  auto line = ReadLine();
  err << std::endl;
  return line;
}

}  // namespace

Result<std::string> AskPassword(const std::string& of_whom, std::ostream& err) {
  const bool is_typed = isatty(STDIN_FILENO) == 1;
  RIGCAL_ASSIGN(std::string password, is_typed ? TypedOnce("Password of " + of_whom + ": ", err) : ReadLine());
  RIGCAL_TRY(CheckPassword(password));
  if (!is_typed) return password;
  RIGCAL_ASSIGN(const std::string again, TypedOnce("The same again: ", err));
  if (again == password) return password;
  return Fail(ErrorCode::kInvalidInput, "the password was not typed alike twice", "Nothing was changed; try again.");
}

}  // namespace rigcal::client

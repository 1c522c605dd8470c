// What every verb shares: the options that all have, and the way from a question to text or JSON.
#pragma once

#include <chrono>
#include <functional>
#include <ostream>
#include <span>
#include <string>

#include "client/connection.h"
#include "client/document.h"
#include "client/exit_code.h"

namespace rigcal::client {

struct Context {
  std::ostream& out;
  std::ostream& err;
  bool err_is_terminal = false;
  bool json = false;
  std::chrono::milliseconds timeout{5000};
  bool timeout_is_given = false;
  wire::ParticipantOptions dds = {};
  ExitCode exit_code = ExitCode::kGood;         // set by the verb that ran
  std::span<const char* const> arguments = {};  // of the whole command line, as given
};

// Report of exit_code.h to the context's streams; with --json also docs/api.md's error document on `out`.
ExitCode Report(const Error& error, const Context& context);

// A verb that asks one question and prints the answer.
struct Question {
  std::string verb;
  std::string parameters = "{}";
  std::function<void(const Document&, std::ostream&)> print;  // for people
  std::function<ExitCode(const Document&)> judge;             // empty: good
};
ExitCode Answer(const Context& context, const Question& question);
// Asks; the error is left to the caller.
[[nodiscard]] Result<std::string> AskOnce(const Context& context, const std::string& verb,
                                          const std::string& parameters);

// kVerdictFail if `verdict` (a verdict of docs/api.md) is "fail".
[[nodiscard]] ExitCode Judge(const Document& verdict);
// "pass" or "fail: why. What to do."
void PrintVerdict(const Document& verdict, std::ostream& out);
[[nodiscard]] std::string VerdictText(const Document& verdict);
// "12 days", or "-".
[[nodiscard]] std::string AgeOf(const Document& age_ns);
// Text of a number, or "-".
[[nodiscard]] std::string CountOf(const Document& number);
// "robot r: a batch of 59 edges is incomplete: 1 of 59 came, the last 2 min ago; none of them counts", of a row of
// `open_batches`, and what to do.
[[nodiscard]] std::string OpenBatchText(const Document& batch);
inline constexpr const char* kCompleteBatch = "Push the same edges again: that completes it, nothing is stored twice";
// "<address>/robots/<robot>/revisions/<n>/", or empty where the server has no HTTP. `status`: its document.
[[nodiscard]] std::string ReportAddress(const Document& status, const std::string& robot, std::int64_t revision);
// The row of a robot in a document with "robots".
[[nodiscard]] Document RobotRow(const Document& document, const std::string& robot);

}  // namespace rigcal::client

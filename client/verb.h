// What every verb shares: the options that all have, and the way from a question to text or JSON.
#pragma once

#include <chrono>
#include <functional>
#include <ostream>
#include <span>
#include <string>

#include "client/exit_code.h"
#include "client/text/document.h"
#include "client/wire/connection.h"
#include "server/model/robots/drive_rule.h"

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
// Prints the answer, or the error to `err`; the code to exit with.
ExitCode Answer(const Context& context, const Question& question);
// Asks; the error is left to the caller.
[[nodiscard]] Result<std::string> AskOnce(const Context& context, const std::string& verb,
                                          const std::string& parameters);

// Of one robot: a verdict of docs/api.md, and the document that has `drive` and `overdue` beside it: what its drive
// rule says; of a server of before, what the verdict and the date say.
[[nodiscard]] DriveKind KindOf(const Document& verdict, const Document& validity);
[[nodiscard]] ExitCode Judge(const Document& verdict, const Document& validity);
// By the verdict and the date alone, of what was just measured: that nobody approved it or that the robot did not apply
// it yet is no fault of the measurement.
[[nodiscard]] ExitCode JudgeMeasured(const Document& verdict, const Document& validity);
// For the help of each verb that ends with Judge.
inline constexpr const char* kVerdictCodes =
    "Exit code: 0 pass, 1 fail, 5 warn, 6 unknown (or overdue, not approved, not what the robot runs).\n";
// Of several robots the worst.
[[nodiscard]] ExitCode Worse(ExitCode a, ExitCode b);
// "OK to drive until 20 Feb 2027.", "Do not drive.", as the server says it; empty where it does not. `document` is one
// of docs/api.md that has `drive`.
[[nodiscard]] std::string DriveText(const Document& document);
// That on a line of its own, if there is any.
void PrintDrive(const Document& document, std::ostream& out);
// "pass" or "fail: why. What to do."; after it what to use instead, and that a newer one is on its way; before it that
// it is overdue, where the drive rule does not say so. `validity`: the members of docs/api.md that `show` has.
void PrintVerdict(const Document& verdict, const Document& validity, std::ostream& out);
// "Keep using revision 4, measured 12 Mar 2026, until 10 Jun 2026, ..." of what is not known; of a fail that it is in
// doubt, too; else empty.
[[nodiscard]] std::string FallbackText(const Document& verdict, const Document& validity);
// "overdue, " or "not calibrated, " where it is so, for what is told of a robot in one line.
[[nodiscard]] std::string OverdueBefore(const Document& validity);
// "pass: why. What to do." `of`: the document that has `robot`, `revision` and `state` beside it: of a candidate
// approving it comes first.
[[nodiscard]] std::string VerdictText(const Document& verdict, const Document& of);
// "31 Jan 2026" of a time of docs/api.md, or "-".
[[nodiscard]] std::string DayOf(const Document& time);
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
// That a file's positions may be in another unit (edges/unit_doubt.h): told, not refused. Nothing of no doubt.
void SayUnitDoubt(const std::string& file, const std::string& doubt, std::ostream& err);
// The row of a robot in a document with "robots".
[[nodiscard]] Document RobotRow(const Document& document, const std::string& robot);

}  // namespace rigcal::client

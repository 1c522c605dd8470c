#include "client/verb.h"

#include <array>

#include "client/text/table.h"
#include "server/base/stamp.h"
#include "server/formats/answers/answers.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/validity.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::client {

Result<std::string> AskOnce(const Context& context, const std::string& verb, const std::string& parameters) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  return connection.Ask(verb, parameters, context.timeout);
}

ExitCode Report(const Error& error, const Context& context) {
  if (context.json) context.out << formats::WriteError(error) << std::endl;
  return Report(error, context.err);
}

ExitCode Answer(const Context& context, const Question& question) {
  const auto text = AskOnce(context, question.verb, question.parameters);
  if (!text) return Report(text.error(), context);
  const auto document = Document::Parse(*text, "the server's answer to '" + question.verb + "'");
  if (!document) return Report(document.error(), context);
  if (context.json)
    context.out << *text << std::endl;
  else
    question.print(*document, context.out);
  context.out.flush();
  return question.judge ? question.judge(*document) : ExitCode::kGood;
}

namespace {

// Of the verdict and the date alone.
DriveKind MeasuredKind(const Document& verdict, const Document& validity) {
  const VerdictLevel level = VerdictLevelOf(verdict["level"].Text());
  if (level == VerdictLevel::kFail) return DriveKind::kDoNotDrive;
  if (level == VerdictLevel::kUnknown || validity["overdue"].Flag()) return DriveKind::kNotVerified;
  return level == VerdictLevel::kWarn ? DriveKind::kOkWithAction : DriveKind::kOk;
}

ExitCode CodeOf(DriveKind kind) {
  switch (kind) {
    case DriveKind::kOk:
      return ExitCode::kGood;
    case DriveKind::kOkWithAction:
      return ExitCode::kVerdictWarn;
    case DriveKind::kDoNotDrive:
      return ExitCode::kVerdictFail;
    case DriveKind::kNotVerified:
    case DriveKind::kNotApplied:
    case DriveKind::kToApprove:
    case DriveKind::kSuperseded:
      break;
  }
  return ExitCode::kVerdictUnknown;
}

}  // namespace

DriveKind KindOf(const Document& verdict, const Document& validity) {
  return DriveKindOf(validity["drive"]["kind"].Text()).value_or(MeasuredKind(verdict, validity));
}

ExitCode Judge(const Document& verdict, const Document& validity) { return CodeOf(KindOf(verdict, validity)); }

ExitCode JudgeMeasured(const Document& verdict, const Document& validity) {
  return CodeOf(MeasuredKind(verdict, validity));
}

namespace {

std::optional<Stamp> StampOf(const Document& text) {
  const auto stamp = ParseIso(text.Text());
  return stamp ? std::optional(*stamp) : std::nullopt;
}

}  // namespace

ExitCode Worse(ExitCode a, ExitCode b) {
  constexpr std::array kFromTheWorst = {ExitCode::kVerdictFail, ExitCode::kVerdictUnknown, ExitCode::kVerdictWarn};
  for (const ExitCode code : kFromTheWorst)
    if (a == code || b == code) return code;
  return a;
}

std::string DriveText(const Document& document) {
  const std::string rule = Plain(document["drive"]["rule"].Text());
  return rule.empty() ? "" : rule + ".";
}

void PrintDrive(const Document& document, std::ostream& out) {
  if (const std::string text = DriveText(document); !text.empty()) out << text << '\n';
}

// What an older server's documents lack is not told.
std::string FallbackText(const Document& verdict, const Document& validity) {
  const Verdict told{VerdictLevelOf(verdict["level"].Text()), "", ""};
  if (IsUsable(told) || !validity.Has("usable")) return "";
  const Document usable = validity["usable"];
  const auto created_at = StampOf(usable["created_at"]);
  if (!created_at) return KeepText(told.level, std::nullopt);
  UsableRevision revision{static_cast<int>(usable["revision"].Integer().value_or(0)), *created_at};
  revision.calibrated_at = StampOf(usable["calibrated_at"]);
  const auto valid_until = StampOf(usable["valid_until"]);
  if (revision.calibrated_at && valid_until) revision.max_age_ns = valid_until->ns - revision.calibrated_at->ns;
  return KeepText(told.level, revision);
}

std::string OverdueBefore(const Document& validity) {
  if (!validity["overdue"].Flag()) return "";
  return validity["calibrated_at"].IsNull() ? "not calibrated, " : "overdue, ";
}

std::string VerdictText(const Document& verdict, const Document& of) {
  std::string text = verdict["level"].Text("unknown");
  const Verdict told{VerdictLevelOf(text), "", verdict["what_to_do"].Text()};
  std::string action = WhatToDo(RobotId(of["robot"].Text("?")), static_cast<int>(of["revision"].Integer().value_or(0)),
                                RevisionStateOf(of["state"].Text()), told);
  const bool is_candidate = RevisionStateOf(of["state"].Text()) == RevisionState::kCandidate;
  if (told.level == VerdictLevel::kPass && of["overdue"].Flag() && !is_candidate)
    action = "Calibrate it again, it is overdue";
  for (const std::string& part : {verdict["why"].Text(), action}) {
    std::string sentence = Plain(part);
    if (sentence.empty()) continue;
    if (sentence.back() != '.') sentence += '.';
    text += (text.find(':') == std::string::npos ? ": " : " ") + sentence;
  }
  return text;
}

void PrintVerdict(const Document& verdict, const Document& validity, std::ostream& out) {
  const bool in_rule = IsUsable({VerdictLevelOf(verdict["level"].Text()), "", ""}) && !DriveText(validity).empty();
  if (validity["overdue"].Flag() && !in_rule) out << OverdueText(StampOf(validity["valid_until"])) << '\n';
  out << "verdict  " << VerdictText(verdict, validity) << '\n';
  if (const std::string text = FallbackText(verdict, validity); !text.empty()) out << "         " << text << '\n';
  if (validity["calculating"].Flag()) out << "         " << kCalculatingText << '\n';
  if (const std::string text = Plain(validity["given_up"].Text()); !text.empty()) out << "         " << text << '\n';
}

std::string DayOf(const Document& time) {
  const auto stamp = StampOf(time);
  return stamp ? DayText(*stamp) : "-";
}

std::string AgeOf(const Document& age_ns) {
  const auto age = age_ns.Integer();
  return age ? AgeText(*age) : "-";
}

std::string CountOf(const Document& number) {
  const auto count = number.Integer();
  return count ? std::to_string(*count) : "-";
}

std::string OpenBatchText(const Document& batch) {
  const std::string edges = CountOf(batch["edges"]);
  return "robot " + Plain(batch["robot"].Text("?")) + ": a batch of " + edges +
         " edges is incomplete: " + CountOf(batch["held"]) + " of " + edges + " came, the last " +
         AgeOf(batch["age_ns"]) + " ago; none of them counts";
}

std::string ReportAddress(const Document& status, const std::string& robot, std::int64_t revision) {
  const std::string address = Plain(status["http_address"].Text());
  if (address.empty()) return "";
  return address + "/robots/" + robot + "/revisions/" + std::to_string(revision) + "/";
}

void SayUnitDoubt(const std::string& file, const std::string& doubt, std::ostream& err) {
  if (!doubt.empty()) err << Plain(file + ": " + doubt) << ' ' << kTakenInMetres << std::endl;
}

Document RobotRow(const Document& document, const std::string& robot) {
  for (const Document& row : document["robots"].Items())
    if (row["robot"].Text() == robot) return row;
  return {};
}

}  // namespace rigcal::client

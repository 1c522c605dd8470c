#include "client/verb.h"

#include "client/table.h"
#include "server/base/stamp.h"
#include "server/formats/answers.h"

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

ExitCode Judge(const Document& verdict) {
  return verdict["level"].Text() == "fail" ? ExitCode::kVerdictFail : ExitCode::kGood;
}

std::string VerdictText(const Document& verdict) {
  std::string text = verdict["level"].Text("unknown");
  for (const char* part : {"why", "what_to_do"}) {
    std::string sentence = Plain(verdict[part].Text());
    if (sentence.empty()) continue;
    if (sentence.back() != '.') sentence += '.';
    text += (text.find(':') == std::string::npos ? ": " : " ") + sentence;
  }
  return text;
}

void PrintVerdict(const Document& verdict, std::ostream& out) { out << "verdict  " << VerdictText(verdict) << '\n'; }

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
  return "robot " + Plain(batch["robot"].Text("?")) + ": a batch of " + edges + " edges is incomplete: " +
         CountOf(batch["held"]) + " of " + edges + " came, the last " + AgeOf(batch["age_ns"]) +
         " ago; none of them counts";
}

std::string ReportAddress(const Document& status, const std::string& robot, std::int64_t revision) {
  const std::string address = Plain(status["http_address"].Text());
  if (address.empty()) return "";
  return address + "/robots/" + robot + "/revisions/" + std::to_string(revision) + "/";
}

Document RobotRow(const Document& document, const std::string& robot) {
  for (const Document& row : document["robots"].Items())
    if (row["robot"].Text() == robot) return row;
  return {};
}

}  // namespace rigcal::client

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "client/certificate/lines.h"
#include "client/certificate/paper.h"
#include "client/positive.h"
#include "client/print/pdf.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kSessionsAsked = 16;  // of many, the newest are among those of the list of sessions

struct CertificateOptions {
  std::string robot, out;
  int revision = 0;
};

// Those that count, the newest first, as the robot's list has them.
Result<std::vector<Document>> AskSessions(Connection& connection, const Context& context,
                                          const CertificateOptions& options, const Document& show) {
  const std::vector<std::string> counted = SessionsCounted(show);
  RIGCAL_ASSIGN(const Document list,
                connection.AskDocument("sessions", JsonObject({{"robot", options.robot}}), context.timeout));
  std::vector<Document> sessions;
  for (const Document& row : list["sessions"].Items()) {
    const std::string id = row["session"].Text();
    if (sessions.size() >= kSessionsAsked || std::find(counted.begin(), counted.end(), id) == counted.end()) continue;
    RIGCAL_ASSIGN(Document session, connection.AskDocument("session", JsonObject({{"id", id}}), context.timeout));
    sessions.push_back(std::move(session));
  }
  return sessions;
}

Result<CertificateDocuments> AskAll(const Context& context, const CertificateOptions& options) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  std::vector<Field> which = {{"robot", options.robot}};
  if (options.revision > 0) which.emplace_back("revision", std::int64_t{options.revision});
  CertificateDocuments documents;
  RIGCAL_ASSIGN(documents.show, connection.AskDocument("show", JsonObject(which), context.timeout));
  RIGCAL_ASSIGN(const Document status,
                connection.AskDocument("status", JsonObject({{"robot", options.robot}}), context.timeout));
  documents.software = status["version"].Text("?");
  RIGCAL_ASSIGN(documents.sessions, AskSessions(connection, context, options, documents.show));
  return documents;
}

Status WriteCertificate(const Context& context, const CertificateOptions& options) {
  if (!options.out.ends_with(".pdf"))
    return Fail(ErrorCode::kInvalidInput, "'" + options.out + "' is not a .pdf", "Give --out a name that ends so.");
  RIGCAL_ASSIGN(const CertificateDocuments documents, AskAll(context, options));
  const std::vector<CertificateLine> lines = CertificateLines(documents);
  RIGCAL_ASSIGN(const print::Sheet sheet, OnPaper(lines));
  const std::string number = CountOf(documents.show["revision"]);
  RIGCAL_ASSIGN(const std::string bytes,
                print::WritePdf(sheet, lines.front().text + " " + options.robot + ", revision " + number));
  RIGCAL_TRY(WriteDurably(options.out, bytes));
  if (context.json)
    context.out << JsonObject({{"file", options.out},
                               {"kind", lines.front().text},
                               {"revision", documents.show["revision"].Integer().value_or(0)},
                               {"robot", options.robot}})
                << std::endl;
  else
    context.out << options.out << ": " << lines.front().text << " of " << options.robot << ", revision " << number
                << ", one page of A4.\n";
  return {};
}

}  // namespace

void AddCertificate(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kCertificateVerb.name, kCertificateVerb.description);
  auto options = std::make_shared<CertificateOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--out", options->out, "The file to write")->required()->type_name("FILE.pdf");
  verb->add_option("--revision", options->revision, "A numbered revision (default: the newest)")
      ->check(Positive())
      ->type_name("N");
  verb->footer(
      "One page of A4: poses with U = k sigma beside their tolerances, the decision rule, what was found and left, "
      "boards,\n"
      "operator, conditions, software and digest. What is not approved is called no certificate.\n"
      "Examples:\n"
      "  rigcal certificate mapper-01 --out mapper-01.pdf\n"
      "  rigcal certificate mapper-01 --revision 3 --out mapper-01-3.pdf\n");
  verb->callback([&context, options] {
    if (const Status done = WriteCertificate(context, *options); !done)
      context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client

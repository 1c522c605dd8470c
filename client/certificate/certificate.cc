#include "server/formats/answers/certificate.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "client/certificate/paper.h"
#include "client/positive.h"
#include "client/print/pdf.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"

namespace rigcal::client {
namespace {

struct CertificateOptions {
  std::string robot, out;
  int revision = 0;
};

Result<Certificate> Ask(const Context& context, const CertificateOptions& options) {
  std::vector<Field> which = {{"robot", options.robot}};
  if (options.revision > 0) which.emplace_back("revision", std::int64_t{options.revision});
  RIGCAL_ASSIGN(const std::string answer, AskOnce(context, "certificate", JsonObject(which)));
  return formats::ReadCertificate(answer);
}

std::string PagesText(std::size_t pages) {
  return pages == 1 ? "one page of A4" : std::to_string(pages) + " pages of A4";
}

Status WriteToFile(const Context& context, const CertificateOptions& options) {
  if (!options.out.ends_with(".pdf"))
    return Fail(ErrorCode::kInvalidInput, "'" + options.out + "' is not a .pdf", "Give --out a name that ends so.");
  RIGCAL_ASSIGN(const Certificate certificate, Ask(context, options));
  const std::vector<print::Sheet> sheets = OnPaper(certificate);
  const std::string of = " of " + options.robot + ", revision " + std::to_string(certificate.revision);
  RIGCAL_ASSIGN(const std::string bytes, print::WritePdf(sheets, certificate.title + of));
  RIGCAL_TRY(WriteDurably(options.out, bytes));
  if (context.json)
    context.out << JsonObject({{"file", options.out},
                               {"kind", certificate.title},
                               {"pages", static_cast<std::int64_t>(sheets.size())},
                               {"revision", std::int64_t{certificate.revision}},
                               {"robot", options.robot}})
                << std::endl;
  else
    context.out << options.out << ": " << certificate.title << of << ", " << PagesText(sheets.size()) << ".\n";
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
      "On A4, one page of most robots: poses with U = k sigma beside their limits, the decision rule, what was found "
      "and left,\n"
      "operator, conditions, boards, software and digest. What is not in use, or overdue, is called no certificate.\n"
      "Examples:\n"
      "  rigcal certificate mapper-01 --out mapper-01.pdf\n"
      "  rigcal certificate mapper-01 --revision 3 --out mapper-01-3.pdf\n");
  verb->callback([&context, options] {
    if (const Status done = WriteToFile(context, *options); !done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client

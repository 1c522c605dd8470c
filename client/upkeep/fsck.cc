#include "storage/upkeep/fsck.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "client/text/document.h"
#include "client/text/table.h"
#include "client/upkeep/options.h"
#include "client/verbs.h"
#include "server/base/files/private_files.h"
#include "server/base/process/thread_rank.h"

namespace rigcal::client {
namespace {

struct FsckWords {
  std::string data, store;
  bool repair = false;
};

std::string StateOf(const storage::Finding& finding) {
  if (!finding.is_damage) return finding.is_mended ? "done" : "note";
  return finding.is_lost ? "lost" : finding.is_mended ? "mended" : "damage";
}

// "nothing is damaged."
std::string CountsOf(const storage::FsckDone& done) {
  const std::string damaged = done.unmended() == 0 ? std::string("nothing ") + (done.lost() > 0 ? "else " : "") + "is"
                                                   : std::to_string(done.unmended()) + " things are";
  if (done.lost() == 0) return damaged + " damaged.";
  return damaged + " damaged; " + std::to_string(done.lost()) +
         " files that robots pushed are lost until they are pushed again.";
}

void PrintJson(const storage::FsckDone& done, std::ostream& out) {
  std::string findings;
  for (const storage::Finding& one : done.findings)
    findings +=
        (findings.empty() ? "" : ",") +
        JsonObject({{"kind", NameOf(one.kind)}, {"state", StateOf(one)}, {"what", one.what}, {"cure", one.cure}});
  out << JsonObject({{"damaged", done.unmended()},
                     {"lost", done.lost()},
                     {"files", done.blobs},
                     {"bytes", done.blob_bytes},
                     {"pages", done.pages},
                     {"pages_without_sum", done.pages_unknown},
                     Field::Raw("findings", "[" + findings + "]")})
      << std::endl;
}

void PrintText(const storage::FsckDone& done, std::ostream& out) {
  for (const storage::Finding& one : done.findings)
    out << StateOf(one) << ": " << Plain(one.what) << ". " << one.cure << "\n";
  if (done.pages > 0) out << done.pages << " pages of the database and ";
  out << done.blobs << " files (" << ByteText(static_cast<double>(done.blob_bytes))
      << ") were looked at: " << CountsOf(done) << "\n";
  if (done.pages_unknown > 0)
    out << "Of " << done.pages_unknown
        << " pages there is no sum yet, so that only SQLite's own checks speak for them; "
        << "`rigcal fsck --repair DATA`, of this folder, makes the sums.\n";
}

Result<ExitCode> Run(const Context& context, const FsckWords& words) {
  SetThreadRank(ThreadRank::kWorks);
  MakePrivateFiles();
  RIGCAL_ASSIGN(const storage::StorePlace place, storage::StorePlaceOf(words.store, words.data));
  Result<storage::FsckDone> done = Fail(ErrorCode::kInternal, "nothing was looked at", "Report this.");
  WithBar(context, "Checking", [&](const auto& progress) {
    done = storage::Fsck({place, words.repair, progress}, SystemClock());
  });
  if (!done) return Fail(done.error());
  context.json ? PrintJson(*done, context.out) : PrintText(*done, context.out);
  return done->unmended() + done->lost() == 0 ? ExitCode::kGood : ExitCode::kVerdictFail;
}

}  // namespace

void AddFsck(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kFsckVerb.name, kFsckVerb.description);
  auto words = std::make_shared<FsckWords>();
  verb->add_option("DATA", words->data, "The data folder of a rigcald")->required();
  verb->add_option("--store", words->store, "Where its rows are, if in PostgreSQL: postgresql://USER@HOST/DATABASE");
  verb->add_flag("--repair", words->repair, "Mend what can be mended; the rigcald must be stopped");
  verb->footer(
      "Looks at the log and every page of the database, every reference and digest within it, and every file that it\n"
      "names. Without --repair nothing is changed and a rigcald may serve meanwhile.\n"
      "With --repair a damaged file is set aside, never deleted: what robots pushed is sent again by pushing its "
      "session\n"
      "again, pictures and documents are made again by the server, indices at once. Files that nothing refers to are\n"
      "removed when they are older than a day.\n"
      "Of a store in PostgreSQL the pages and indices are that server's own to check: it is told whether its "
      "checksums\n"
      "are on. All else is checked and mended alike.\n"
      "Exit code: 0 nothing is damaged (any more), 1 something is, or is lost until it is pushed again, 4 the folder\n"
      "cannot be looked at.\n"
      "Examples:\n"
      "  rigcal fsck /var/lib/rigcal\n"
      "  rigcal fsck /var/lib/rigcal --repair\n"
      "  rigcal fsck /var/lib/rigcal --store postgresql://rigcal@db.example.org/rigcal\n"
      "  rigcal fsck /var/lib/rigcal --json > fsck.json\n");
  verb->callback([&context, words] {
    const auto code = Run(context, *words);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client

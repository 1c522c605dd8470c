#include "storage/upkeep/backup.h"

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

struct BackupWords {
  std::string folder, data = DefaultDataFolder();
  bool link = false, verify = false;
};

void PrintJson(const storage::BackupDone& done, std::ostream& out) {
  std::string lost;
  for (const std::string& one : done.lost) lost += (lost.empty() ? "" : ",") + JsonObject({{"what", one}});
  out << JsonObject({{"backup", std::int64_t{done.label.number}},
                     {"made_at", ToIso(done.label.made_at)},
                     {"files", done.label.blobs},
                     {"copied", done.copied},
                     {"copied_bytes", done.copied_bytes},
                     {"known_lost", done.known_lost},
                     Field::Raw("lost", "[" + lost + "]")})
      << std::endl;
}

void PrintText(const storage::BackupDone& done, const std::string& folder, std::ostream& out) {
  out << "Backup " << done.label.number << " in " << folder << " is complete: " << done.label.blobs
      << " files and the database as of " << ToIso(done.label.made_at) << "; " << done.copied << " of them are new ("
      << ByteText(static_cast<double>(done.copied_bytes)) << " copied).\n";
  if (done.known_lost > 0)
    out << done.known_lost << " files are not in it: the store had lost them before (`rigcal doctor`).\n";
  for (const std::string& one : done.lost) out << "Not in it: " << one << ".\n";
  if (!done.lost.empty()) out << "Run `rigcal fsck` on the data folder.\n";
}

Result<ExitCode> Run(const Context& context, const BackupWords& words) {
  SetThreadRank(ThreadRank::kWorks);  // the server has more urgent work than this
  MakePrivateFiles();
  Result<storage::BackupDone> done = Fail(ErrorCode::kInternal, "no backup was made", "Report this.");
  WithBar(context, "Copying", [&](const auto& progress) {
    done = storage::MakeBackup({words.data, words.folder,
                                words.link ? storage::CopyHow::kLink : storage::CopyHow::kCopy, words.verify, progress},
                               SystemClock());
  });
  if (!done) return Fail(done.error());
  if (IsOpenToOthers(words.folder)) context.err << "Note: " << OpenFolderText(words.folder) << "." << std::endl;
  context.json ? PrintJson(*done, context.out) : PrintText(*done, words.folder, context.out);
  return done->lost.empty() ? ExitCode::kGood : ExitCode::kVerdictFail;
}

}  // namespace

void AddBackup(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kBackupVerb.name, kBackupVerb.description);
  auto words = std::make_shared<BackupWords>();
  verb->add_option("DIR", words->folder, "The backup's folder: new, empty, or of an earlier backup")->required();
  verb->add_option("--data", words->data, "Data folder of the rigcald, on this machine")
      ->type_name("DIR")
      ->capture_default_str();
  verb->add_flag("--link", words->link,
                 "Hard links instead of copies, on the same disk: quick, but no help against that disk");
  verb->add_flag("--verify", words->verify, "Also hold what earlier backups have copied against its digest");
  verb->footer(
      "The rigcald may serve meanwhile: whatever has a receipt when it begins is in it. The same folder again copies "
      "only\n"
      "what is new, and after Ctrl-C or power loss it goes on; the last complete backup stays until the next one is.\n"
      "In it: the database, and every file that it names, held against its digest. Not in it: reports, which are drawn "
      "again\n"
      "(docs/operations.md).\n"
      "Exit code: 0 good, 1 files that robots pushed are missing in the store, 4 no backup was made.\n"
      "Examples:\n"
      "  rigcal backup /mnt/backup/rigcal\n"
      "  rigcal backup /mnt/backup/rigcal --data /var/lib/rigcal\n");
  verb->callback([&context, words] {
    const auto code = Run(context, *words);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client

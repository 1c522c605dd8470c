#include "storage/upkeep/restore_backup.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "client/text/document.h"
#include "client/text/table.h"
#include "client/upkeep/options.h"
#include "client/verbs.h"
#include "server/base/files/private_files.h"

namespace rigcal::client {
namespace {

struct RestoreWords {
  std::string folder, data;
  int number = 0;
};

std::string JsonTexts(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& one : texts) list += (list.empty() ? "" : ",") + Field("", one).json;
  return "[" + list + "]";
}

// What a backup cannot know: who was let in no longer after it was made.
void PrintWhoIsIn(const storage::Restored& restored, std::ostream& out) {
  if (restored.users.empty() && restored.tokens.empty()) return;
  out << "Who may log in is as it was then, and whoever was logged in is so no longer. Revoke again what was taken "
         "back since:\n";
  for (const std::string& name : restored.users) out << "  user " << name << "\n";
  for (const std::string& name : restored.tokens) out << "  token " << name << "\n";
}

void PrintJson(const storage::Restored& restored, std::ostream& out) {
  std::string lost;
  for (const std::string& one : restored.lost) lost += (lost.empty() ? "" : ",") + JsonObject({{"what", one}});
  out << JsonObject({{"backup", std::int64_t{restored.label.number}},
                     {"made_at", ToIso(restored.label.made_at)},
                     {"files", restored.blobs},
                     {"bytes", restored.bytes},
                     Field::Raw("lost", "[" + lost + "]"),
                     Field::Raw("tokens", JsonTexts(restored.tokens)),
                     Field::Raw("users", JsonTexts(restored.users))})
      << std::endl;
}

void PrintText(const storage::Restored& restored, const std::string& data, std::ostream& out) {
  out << "Restored backup " << restored.label.number << " of " << ToIso(restored.label.made_at) << " to " << data
      << ": " << restored.blobs << " files, " << ByteText(static_cast<double>(restored.bytes)) << ", each as it was.\n";
  for (const std::string& one : restored.lost) out << "Lost: " << one << ".\n";
  if (!restored.lost.empty() && !restored.losses_noted)
    out << "Run `rigcal fsck " << data << " --repair`, then push these sessions again.\n";
  if (!restored.lost.empty() && restored.losses_noted)
    out << "Push these sessions again: what is lost is sent then, and nothing else.\n";
  PrintWhoIsIn(restored, out);
  out << "Start it with: rigcald --data " << data << "\n";
}

Result<ExitCode> Run(const Context& context, const RestoreWords& words) {
  MakePrivateFiles();
  Result<storage::Restored> restored = Fail(ErrorCode::kInternal, "nothing was restored", "Report this.");
  WithBar(context, "Restoring", [&](const auto& progress) {
    restored = storage::RestoreBackup({words.folder, words.data, words.number, progress});
  });
  if (!restored) return Fail(restored.error());
  context.json ? PrintJson(*restored, context.out) : PrintText(*restored, words.data, context.out);
  return restored->lost.empty() ? ExitCode::kGood : ExitCode::kVerdictFail;
}

}  // namespace

void AddRestoreBackup(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kRestoreBackupVerb.name, kRestoreBackupVerb.description);
  auto words = std::make_shared<RestoreWords>();
  verb->add_option("DIR", words->folder, "The folder that `rigcal backup` made")->required();
  verb->add_option("DATA", words->data, "The data folder to be: new or empty")->required();
  verb->add_option("--number", words->number, "Which of its backups (default: the newest)")
      ->type_name("N")
      ->check(CLI::Range(1, 999'999'999));
  verb->footer(
      "Every file is held against its digest. A folder that is in use or not empty is refused; broken off, there is "
      "none,\n"
      "and the same command begins anew. What was pushed after the backup is pushed again: nothing is stored twice.\n"
      "Exit code: 0 good, 1 files that robots pushed are not in the backup, 4 nothing was restored.\n"
      "Examples:\n"
      "  rigcal restore-backup /mnt/backup/rigcal /var/lib/rigcal\n"
      "  rigcal restore-backup /mnt/backup/rigcal restored/ --number 6\n");
  verb->callback([&context, words] {
    const auto code = Run(context, *words);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client

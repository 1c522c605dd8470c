#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "client/text/document.h"
#include "client/text/progress.h"
#include "client/text/table.h"
#include "client/upkeep/own_store.h"
#include "client/verbs.h"
#include "client/wire/transfer.h"
#include "server/base/files/private_files.h"
#include "storage/move/move_store.h"

namespace rigcal::client {
namespace {

struct MigrateWords {
  std::string from, to, data;
  bool copy = false;
};

// One bar after another.
class StageBar {
 public:
  explicit StageBar(const Context& context) : context_(context) {}
  ~StageBar() { Clear(); }
  StageBar(const StageBar&) = delete;
  StageBar& operator=(const StageBar&) = delete;

  void Show(storage::MoveStage stage, std::int64_t done, std::int64_t total) {
    if (!bar_ || stage != stage_) Begin(stage);
    if (bar_->IsDue(SteadyNow_ns())) bar_->Show({done, total, ""}, SteadyNow_ns());
  }

 private:
  void Begin(storage::MoveStage stage) {
    constexpr const char* kLabels[] = {"Copying", "Comparing", "Copying"};
    Clear();
    stage_ = stage;
    const auto unit = stage == storage::MoveStage::kCopyingFiles ? Progress::Unit::kFiles : Progress::Unit::kRows;
    bar_.emplace(context_.err, context_.err_is_terminal, kLabels[static_cast<std::size_t>(stage)], SteadyNow_ns(),
                 unit);
  }
  void Clear() {
    if (bar_) bar_->Clear();
    bar_.reset();
  }

  const Context& context_;
  storage::MoveStage stage_{};
  std::optional<Progress> bar_;
};

// Of the two stores one may be in PostgreSQL, with its files in --data.
Result<storage::MoveOptions> OptionsFrom(const MigrateWords& words) {
  storage::MoveOptions options;
  RIGCAL_ASSIGN(options.from, storage::StorePlaceOf(words.from, words.data));
  RIGCAL_ASSIGN(options.to, storage::StorePlaceOf(words.to, words.data));
  options.how = words.copy ? storage::CopyHow::kCopy : storage::CopyHow::kLink;
  const bool from_server = !options.from.server.empty(), to_server = !options.to.server.empty();
  if (from_server && to_server)
    return Fail(ErrorCode::kInvalidInput, "both stores are in PostgreSQL",
                "Use pg_dump and pg_restore for the rows, and then copy the folder.");
  if ((from_server || to_server) && words.data.empty())
    return Fail(ErrorCode::kInvalidInput, "where are the files of the store in PostgreSQL?",
                "Give with --data the folder that its rigcald has, or will have.");
  if (!from_server && !to_server && !words.data.empty())
    return Fail(ErrorCode::kInvalidInput, "--data is the folder of a store in PostgreSQL, and neither of these is",
                "Leave it out.");
  return options;
}

void PrintJson(const storage::MoveOptions& options, const storage::Moved& moved, std::ostream& out) {
  std::string lost;
  for (const std::string& one : moved.lost) lost += (lost.empty() ? "" : ",") + JsonObject({{"what", one}});
  out << JsonObject({{"from", NameOf(options.from)},
                     {"to", NameOf(options.to)},
                     {"data", options.to.folder.string()},
                     Field::Raw("went_on", moved.went_on ? "true" : "false"),
                     Field::Raw("was_complete", moved.was_there ? "true" : "false"),
                     {"tables", moved.tables},
                     {"rows", moved.rows},
                     {"files", moved.files},
                     {"copied_bytes", moved.copied_bytes},
                     {"known_lost", moved.known_lost},
                     Field::Raw("lost", "[" + lost + "]")})
      << std::endl;
}

std::string StartText(const storage::StorePlace& place) {
  const std::string store = place.server.empty() ? "" : " --store " + NameOf(place);
  return "rigcald" + store + " --data " + place.folder.string();
}

void PrintText(const storage::MoveOptions& options, const storage::Moved& moved, std::ostream& out) {
  if (moved.was_there)
    out << "The copy at " << NameOf(options.to) << " was complete already.\n";
  else
    out << "The store is at " << NameOf(options.to) << ": " << moved.rows << " rows of " << moved.tables
        << " tables, each the same as before, and " << moved.files << " files ("
        << ByteText(static_cast<double>(moved.copied_bytes)) << " copied, the rest linked)"
        << (moved.went_on ? "; it went on where it was broken off" : "") << ".\n";
  if (moved.known_lost > 0)
    out << moved.known_lost << " files are not in it: the store had lost them before (`rigcal doctor`).\n";
  for (const std::string& one : moved.lost) out << "Not in it: " << one << ".\n";
  out << "Start it with: " << StartText(options.to) << "\n"
      << "The store at " << NameOf(options.from) << " is as it was. Start no server on it any more: what it took in "
      << "would not be in the other.\n";
}

Result<ExitCode> Run(const Context& context, const MigrateWords& words) {
  MakePrivateFiles();
  RIGCAL_ASSIGN(storage::MoveOptions options, OptionsFrom(words));
  RIGCAL_TRY(CheckOwner(options.from.folder.string()));
  RIGCAL_TRY(CheckOwner(options.to.folder.string()));
  StageBar bar(context);
  options.progress = [&](storage::MoveStage stage, std::int64_t done, std::int64_t total) {
    bar.Show(stage, done, total);
  };
  RIGCAL_ASSIGN(const storage::Moved moved, storage::MoveStore(options));
  context.json ? PrintJson(options, moved, context.out) : PrintText(options, moved, context.out);
  return moved.lost.empty() ? ExitCode::kGood : ExitCode::kVerdictFail;
}

}  // namespace

void AddMigrateStore(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kMigrateStoreVerb.name, kMigrateStoreVerb.description);
  auto words = std::make_shared<MigrateWords>();
  verb->add_option("FROM", words->from, "The store as it is: sqlite:DIR, or postgresql://USER@HOST/DATABASE")
      ->required();
  verb->add_option("TO", words->to, "Where it is to be, likewise; a new folder, a database without a store")
      ->required();
  verb->add_option("--data", words->data, "The folder with the files of the one in PostgreSQL")->type_name("DIR");
  verb->add_flag("--copy", words->copy, "Copy files also where they could be links (on one file system)");
  verb->footer(
      "No server may run on the store; it stays as it is. Every row is in the copy, under the same id and compared "
      "with "
      "the\n"
      "first, and every file that a row names, held against its digest; until then no server starts on the copy. "
      "Broken "
      "off\n"
      "by Ctrl-C, kill -9 or power loss, the same command goes on; where the store has changed since, it begins anew.\n"
      "Reports are drawn again, who is logged in stays so. A password for PostgreSQL belongs in ~/.pgpass.\n"
      "Exit code: 0 good, 1 files that robots pushed are missing in the store, 4 there is no store at TO.\n"
      "Examples:\n"
      "  rigcal migrate-store sqlite:/var/lib/rigcal postgresql://rigcal@db.example.org/rigcal --data /srv/rigcal\n"
      "  rigcal migrate-store postgresql://rigcal@db.example.org/rigcal sqlite:/srv/alone --data /srv/rigcal\n"
      "  rigcal migrate-store sqlite:/var/lib/rigcal postgresql:///rigcal --data /srv/rigcal --json\n");
  verb->callback([&context, words] {
    const auto code = Run(context, *words);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client

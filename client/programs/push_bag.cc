#include "client/programs/push_bag.h"

#include <unistd.h>

#include "client/import/files/held_folder.h"
#include "client/import/report.h"
#include "client/programs/bag_work.h"
#include "client/push/bag_path.h"
#include "client/push/push.h"
#include "server/base/process/thread_rank.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

Status CheckPlace(const fs::path& folder) {
  const fs::path place = folder.parent_path().empty() ? fs::path(".") : folder.parent_path();
  std::error_code failed;
  if (!fs::exists(place, failed) || access(place.c_str(), W_OK) == 0) return {};  // what is missing will be made
  return Fail(ErrorCode::kStorage, place.string() + " cannot be written, where the bag becomes a session folder",
              "Give a folder with room by --work DIR.");
}

importing::ImportInput InputOf(const PushOptions& options, const fs::path& folder) {
  importing::ImportInput input{options.folder, options.bag.rig, folder, NanosecondsIfGiven(options.bag.tolerance_s),
                               NanosecondsIfGiven(options.bag.every_s)};
  input.replaces_other_import = true;
  return input;
}

// Prints what became of the bag, as far as it was read now.
Result<ExitCode> MakeFolder(const Context& context, const PushOptions& options, const fs::path& folder) {
  const importing::ImportInput input = InputOf(options, folder);
  RIGCAL_ASSIGN(const importing::ImportOutcome outcome,
                WithBar(context, [&](const auto& progress) { return importing::Import(input, progress); }));
  importing::PrintOutcome(outcome, folder.string(), context.err);
  return TellMissing(outcome, context);
}

Status SendFolder(Context& context, const PushOptions& options, const fs::path& folder) {
  PushOptions of_folder = options;
  of_folder.folder = folder.string();
  const Status sent = PushFolder(context, of_folder);
  std::error_code failed;
  if (sent)
    fs::remove_all(folder, failed);
  else
    context.err << "What was read of the bag is in " << folder.string() << ": the same command goes on there.\n";
  return sent;
}

Status PushOneBag(Context& context, const PushOptions& options) {
  SetThreadRank(ThreadRank::kWorks);  // the robot has more urgent work than this
  const fs::path folder = PushFolderOf(options.folder, options.bag.work);
  RIGCAL_TRY(CheckPlace(folder));
  RIGCAL_ASSIGN(const importing::HeldFolder held, importing::HeldFolder::Take(folder));  // until it is sent and removed
  RIGCAL_ASSIGN(const ExitCode read, MakeFolder(context, options, folder));
  RIGCAL_TRY(SendFolder(context, options, folder));
  if (context.exit_code == ExitCode::kGood) context.exit_code = read;
  return {};
}

}  // namespace

void AddPushOfBags(CLI::App& app, Context& context) { AddPushWith(app, context, PushOneBag); }

}  // namespace rigcal::client

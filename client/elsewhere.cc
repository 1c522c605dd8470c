#include "client/elsewhere.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "client/verbs.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

// Beside this program in a build folder; in the folder for such programs where it is installed.
std::vector<fs::path> Places(const std::string& program) {
  std::error_code failed;
  const fs::path own = fs::read_symlink("/proc/self/exe", failed).parent_path();
  if (failed) return {};
  return {own / program, (own / RIGCAL_LIBEXEC / program).lexically_normal()};
}

}  // namespace

Error StartElsewhere(Context& context, const std::string& name) {
  const std::string program = "rigcal-" + name;
  std::vector<char*> arguments;
  for (const char* argument : context.arguments) arguments.push_back(const_cast<char*>(argument));
  arguments.push_back(nullptr);
  context.out.flush();
  context.err.flush();
  const std::vector<fs::path> places = Places(program);
  for (const fs::path& place : places) execv(place.c_str(), arguments.data());
  return {ErrorCode::kUnsupported, "the program " + program + " is not where it belongs",
          places.empty() ? "Install rigcal whole" : "Install rigcal whole, or put it at " + places.back().string()};
}

namespace {

// Programs of their own: what they do needs OpenCV with some 140 libraries behind it, and loading them would cost every
// other verb a tenth of a second; or the store, which no other verb may touch.
void AddElsewhere(CLI::App& app, Context& context, const std::string& name, const std::string& description,
                  const std::string& program) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->set_help_flag();
  verb->fallthrough(false);
  verb->prefix_command();
  verb->callback([&context, program] { context.exit_code = Report(StartElsewhere(context, program), context); });
}

}  // namespace

void AddSimulateElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "simulate", kSimulateDescription, "simulate");
}

void AddCheckElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "check", kCheckDescription, "check");
}

void AddCompanionElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "companion", kCompanionDescription, "companion");
}

void AddImportElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "import", kImportDescription, "import");
}

void AddBackupElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "backup", kBackupDescription, "upkeep");
}

void AddRestoreBackupElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "restore-backup", kRestoreBackupDescription, "upkeep");
}

void AddFsckElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "fsck", kFsckDescription, "upkeep");
}

void AddUserElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "user", kUserDescription, "upkeep");
}

void AddTokenElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "token", kTokenDescription, "upkeep");
}

void AddRecordElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "record", kRecordDescription, "import");
}

void AddReplayElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, "replay", kReplayDescription, "import");
}

}  // namespace rigcal::client

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

std::string ProgramOf(const std::string& verb) {
  for (const VerbElsewhere& one :
       {kSimulateVerb, kCheckVerb, kCompanionVerb, kImportVerb, kRecordVerb, kReplayVerb, kCertificateVerb, kBackupVerb,
        kRestoreBackupVerb, kFsckVerb, kMigrateStoreVerb, kUserVerb, kTokenVerb, kIdentityVerb, kSupportBundleVerb})
    if (verb == one.name) return one.program;
  return "";
}

// What these do needs OpenCV with some 140 libraries behind it, and loading them would cost every other verb a tenth of
// a second; or the store, which no other verb may touch.
void AddElsewhere(CLI::App& app, Context& context, const VerbElsewhere& verb) {
  CLI::App* added = app.add_subcommand(verb.name, verb.description);
  added->set_help_flag();
  added->fallthrough(false);
  added->prefix_command();
  added->callback(
      [&context, program = verb.program] { context.exit_code = Report(StartElsewhere(context, program), context); });
}

}  // namespace rigcal::client

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "client/verbs.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "rigcal-simulate";

// Beside this program in a build folder; in the folder for such programs where it is installed.
std::vector<fs::path> Places() {
  std::error_code failed;
  const fs::path own = fs::read_symlink("/proc/self/exe", failed).parent_path();
  if (failed) return {};
  return {own / kProgram, (own / RIGCAL_LIBEXEC / kProgram).lexically_normal()};
}

// Returns only if it cannot be started. The program has the same options as this one, so it gets all that was given.
Error Start(Context& context) {
  std::vector<char*> arguments;
  for (const char* argument : context.arguments) arguments.push_back(const_cast<char*>(argument));
  arguments.push_back(nullptr);
  context.out.flush();
  context.err.flush();
  const std::vector<fs::path> places = Places();
  for (const fs::path& place : places) execv(place.c_str(), arguments.data());
  return {ErrorCode::kUnsupported, "the simulator (" + std::string(kProgram) + ") is not where it belongs",
          places.empty() ? "Install rigcal whole" : "Install rigcal whole, or put it at " + places.back().string()};
}

}  // namespace

// A program of its own: the simulator needs OpenCV with some 140 libraries behind it, and loading them would cost every
// other verb a tenth of a second.
void AddSimulateElsewhere(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("simulate", "Write the session of a virtual robot, with its truth");
  verb->set_help_flag();
  verb->fallthrough(false);
  verb->prefix_command();
  verb->callback([&context] { context.exit_code = Report(Start(context), context); });
}

}  // namespace rigcal::client

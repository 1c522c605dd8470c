#include "client/command_line.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>

#include "client/completion/command_words.h"
#include "client/completion/completion.h"
#include "client/verbs.h"
#include "server/base/version.h"

namespace rigcal::client {
namespace {

constexpr const char* kFooter =
    "Exit codes: 0 good, 1 verdict fail, 2 usage, 3 no server answers, 4 input refused, 5 verdict warn,\n"
    "6 verdict unknown or calibration overdue. A verdict is told by push, push-edges, show, lookup and status, and by\n"
    "retire, restore, epoch and policy set once its revision is there; of several robots the worst.\n"
    "Examples:\n"
    "  rigcal import drive.mcap --list          what is in a bag, and which topic may be which sensor\n"
    "  rigcal check visit-2026-01-31/           will the session do? before it is pushed\n"
    "  rigcal companion visit-2026-01-31/       where to hold the board next, while it is taken\n"
    "  rigcal push visit-2026-01-31/            send a session, wait for its result\n"
    "  rigcal push drive.mcap --rig rig.yaml    the same of a bag\n"
    "  rigcal lookup mapper-01 front_left lidar  the pose of the lidar in the front left camera\n"
    "  rigcal doctor                            what is in the way between here and the server\n";

struct GlobalOptions {
  double timeout_s = 5.0;
  int domain = 0;
  std::string tag, identity;
};

void AddGlobalOptions(CLI::App& app, GlobalOptions& options, Context& context) {
  app.add_flag("--json", context.json, "Print JSON: the server's document of docs/api.md, or the verb's own");
  app.add_option("--domain", options.domain, "DDS domain, 0..230 (default: RIGCAL_DOMAIN, else 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 230));
  app.add_option("--tag", options.tag,
                 "DDS discovery tag: sees only servers with the same one (default: RIGCAL_DDS_TAG)")
      ->type_name("NAME");
  app.add_option("--dds-identity", options.identity,
                 "Folder of the identity to take part in DDS with, of `rigcal identity` (default: RIGCAL_DDS_IDENTITY)")
      ->type_name("DIR");
  app.add_option("--timeout", options.timeout_s, "Seconds to wait for an answer (default 5)")
      ->type_name("S")
      ->check(CLI::Range(0.01, 86'400.0));
  app.set_version_flag("--version", "rigcal " + std::string(Version()) + ", protocol " + std::to_string(kWireProtocol));
}

// What is said on the command line wins over the environment, which the DDS layer reads.
void Apply(const CLI::App& app, const GlobalOptions& options, Context& context) {
  context.timeout_is_given = app.count("--timeout") > 0;
  if (app.count("--domain") > 0) setenv("RIGCAL_DOMAIN", std::to_string(options.domain).c_str(), 1);
  if (!options.identity.empty()) setenv("RIGCAL_DDS_IDENTITY", options.identity.c_str(), 1);
  context.dds.tag = options.tag;
  context.timeout = std::chrono::milliseconds(std::llround(options.timeout_s * 1e3));
}

constexpr AddVerb kVerbs[] = {AddPush,
                              AddPushEdges,
                              AddRestore,
                              AddRetire,
                              AddRobots,
                              AddSessions,
                              AddEdges,
                              AddShow,
                              AddHistory,
                              AddLookup,
                              AddStatus,
                              AddWatch,
                              AddReport,
                              AddDue,
                              AddCompare,
                              AddExport,
                              AddDiff,
                              AddDoctor,
                              AddElsewhere<kCheckVerb>,
                              AddElsewhere<kCompanionVerb>,
                              AddElsewhere<kSimulateVerb>,
                              AddElsewhere<kImportVerb>,
                              AddElsewhere<kRecordVerb>,
                              AddElsewhere<kReplayVerb>,
                              AddCompletion,
                              AddPolicy,
                              AddApprove,
                              AddReject,
                              AddRollback,
                              AddAgent,
                              AddTf,
                              AddAudit,
                              AddModel,
                              AddFleet,
                              AddEpoch,
                              AddBoard,
                              AddWebhooks,
                              AddResolve,
                              AddElsewhere<kCertificateVerb>,
                              AddElsewhere<kBackupVerb>,
                              AddElsewhere<kRestoreBackupVerb>,
                              AddElsewhere<kFsckVerb>,
                              AddElsewhere<kMigrateStoreVerb>,
                              AddElsewhere<kUserVerb>,
                              AddElsewhere<kTokenVerb>,
                              AddElsewhere<kIdentityVerb>,
                              AddElsewhere<kSupportBundleVerb>};

// At the end of the help of every verb, and of what it has below it. A script for a shell is no document.
void NameGlobalOptions(CLI::App& app) {
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) {
    const std::string json = verb->get_name() == "completion" ? "" : "--json (a document in place of text), ";
    const std::string before = verb->get_footer();
    verb->footer(before + (before.empty() || before.back() == '\n' ? "" : "\n") + "Options of every verb: " + json +
                 "--domain N, --tag NAME, --timeout S; `rigcal --help` explains them.\n");
    NameGlobalOptions(*verb);
  }
}

bool IsOptionOf(const CLI::App* app, const std::string& word) {
  for (; app != nullptr; app = app->get_parent())
    if (app->get_option_no_throw(word) != nullptr) return true;
  return false;
}

// A value that was forgotten would be the name of the option after it: "--reason --by Ada".
void RefuseOptionsAsValues(CLI::App& app) {
  const CLI::Validator no_option(
      [verb = &app](const std::string& word) {
        return word.starts_with("--") && IsOptionOf(verb, word) ? "needs a value, and " + word + " is an option"
                                                                : std::string();
      },
      "");
  const auto takes_value = [](const CLI::Option* one) {
    return one->nonpositional() && one->get_items_expected_min() > 0;
  };
  for (CLI::Option* option : app.get_options(takes_value)) option->check(no_option);
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) RefuseOptionsAsValues(*verb);
}

int ReportUsage(const std::string& what, const Context& context) {
  context.err << "rigcal: " << what << "\nSee `rigcal --help`, or `rigcal VERB --help` with examples.\n";
  return static_cast<int>(ExitCode::kUsage);
}

// CLI11 says "Could not convert: --revision = 99999999999999999999".
std::string NoValueText(const CLI::ConversionError& error) {
  constexpr std::string_view kBefore = "Could not convert: ";
  std::string said = error.what();
  if (!said.starts_with(kBefore)) return said;
  return said.substr(kBefore.size()) + ": no number that can be taken here, or too large a one";
}

int Parse(CLI::App& app, int argc, const char* const* argv, const Context& context) {
  try {
    app.parse(argc, argv);
    return static_cast<int>(context.exit_code);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request, context.out, context.err);
  } catch (const CLI::ConversionError& error) {
    return ReportUsage(NoValueText(error), context);
  } catch (const CLI::ValidationError& error) {
    return ReportUsage(error.what(), context);
  } catch (const CLI::ParseError& error) {
    const std::string unknown = UnknownWordText(app);
    return ReportUsage(unknown.empty() ? error.what() : unknown, context);
  }
}

}  // namespace

int RunCommandLine(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal,
                   std::span<const AddVerb> verbs) {
  Context context{out, err};
  context.err_is_terminal = err_is_terminal;
  context.arguments = {argv, static_cast<std::size_t>(argc)};
  try {
    GlobalOptions options;
    CLI::App app("Calibrates robots: pushes sessions to rigcald and asks for what came out.", "rigcal");
    app.fallthrough();  // global options may stand after the verb
    app.footer(kFooter);
    AddGlobalOptions(app, options, context);
    app.parse_complete_callback([&] { Apply(app, options, context); });
    for (const AddVerb add : verbs) add(app, context);
    NameGlobalOptions(app);
    RefuseOptionsAsValues(app);
    app.require_subcommand(1);
    if (AsksForCompletion(context)) {
      CompleteWords(app, context);
      return static_cast<int>(context.exit_code);
    }
    return Parse(app, argc, argv, context);
  } catch (const std::exception& error) {
    err << "rigcal: a fault of its own: " << error.what() << ". Please report it with the command line." << std::endl;
    return static_cast<int>(ExitCode::kRefused);
  }
}

int RunCommandLine(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal) {
  return RunCommandLine(argc, argv, out, err, err_is_terminal, kVerbs);
}

}  // namespace rigcal::client

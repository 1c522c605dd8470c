// The verbs of `rigcal`, one file each: Add...() declares its options, its help and what runs.
#pragma once

#include <array>

#include "client/verb.h"

namespace CLI {
class App;
}

namespace rigcal::client {

using AddVerb = void (*)(CLI::App& app, Context& context);

// Each adds its verb: options, help, and what runs when its words have been read. `context` outlives `app`, and gets
// the exit code.
void AddPush(CLI::App& app, Context& context);
void AddPushEdges(CLI::App& app, Context& context);
void AddRestore(CLI::App& app, Context& context);
void AddRetire(CLI::App& app, Context& context);
inline constexpr std::array<const char*, 3> kPolicyActions = {"show", "check", "set"};
inline constexpr std::array<const char*, 5> kBoardActions = {"print", "measure", "list", "show", "trace"};
// Boards as reference standards: `print` starts the program `rigcal-board`, which has AddBoardPrint.
void AddBoard(CLI::App& app, Context& context);
void AddBoardPrint(CLI::App& app, Context& context);
// policy, and the verbs that ask the server what it knows.
void AddPolicy(CLI::App& app, Context& context);
void AddModel(CLI::App& app, Context& context);  // rig models: show, list, check, set
void AddFleet(CLI::App& app, Context& context);  // how sensors sit on the robots of a rig model
void AddEpoch(CLI::App& app, Context& context);
inline constexpr std::array<const char*, 4> kModelActions = {"show", "list", "check", "set"};
void AddApprove(CLI::App& app, Context& context);
void AddReject(CLI::App& app, Context& context);
void AddRollback(CLI::App& app, Context& context);
void AddResolve(CLI::App& app, Context& context);  // computes stored sessions again
void AddAgent(CLI::App& app, Context& context);
void AddTf(CLI::App& app, Context& context);
void AddAudit(CLI::App& app, Context& context);
void AddWebhooks(CLI::App& app, Context& context);
void AddRobots(CLI::App& app, Context& context);
void AddSessions(CLI::App& app, Context& context);
void AddEdges(CLI::App& app, Context& context);
void AddShow(CLI::App& app, Context& context);
void AddHistory(CLI::App& app, Context& context);
void AddLookup(CLI::App& app, Context& context);
void AddStatus(CLI::App& app, Context& context);
void AddWatch(CLI::App& app, Context& context);
void AddReport(CLI::App& app, Context& context);
void AddDue(CLI::App& app, Context& context);
void AddCompare(CLI::App& app, Context& context);
void AddExport(CLI::App& app, Context& context);
void AddDiff(CLI::App& app, Context& context);
void AddDoctor(CLI::App& app, Context& context);
inline constexpr std::array<const char*, 3> kShells = {"bash", "zsh", "fish"};  // that `completion` has a script for
void AddCompletion(CLI::App& app, Context& context);                            // prints that script

// A verb of a program of its own beside `rigcal`: programs/, upkeep/.
struct VerbElsewhere {
  const char* name;
  const char* description;
  const char* program;  // `rigcal-` before it
};
inline constexpr VerbElsewhere kSimulateVerb{"simulate", "Write the session of a virtual robot, with its truth",
                                             "simulate"};
inline constexpr VerbElsewhere kCheckVerb{"check", "Say whether a session folder will do, and what to take more of",
                                          "check"};
inline constexpr VerbElsewhere kCompanionVerb{"companion", "Say where to hold the board next, while a session is taken",
                                              "companion"};
inline constexpr VerbElsewhere kImportVerb{"import", "Make a session folder of a bag, or say what is in the bag",
                                           "import"};
inline constexpr VerbElsewhere kRecordVerb{
    "record", "Record a session, or a bag, from the live topics of a ROS 2 robot", "import"};
inline constexpr VerbElsewhere kReplayVerb{"replay", "Publish a bag as the topics of a ROS 2 robot, at its pace",
                                           "import"};
inline constexpr VerbElsewhere kCertificateVerb{"certificate", "Write a robot's calibration on paper, to sign",
                                                "board"};
inline constexpr VerbElsewhere kBackupVerb{
    "backup", "Copy the data folder of a rigcald on this machine, while it serves", "upkeep"};
inline constexpr VerbElsewhere kRestoreBackupVerb{"restore-backup", "Make a data folder of a backup", "upkeep"};
inline constexpr VerbElsewhere kFsckVerb{
    "fsck", "Say whether a data folder is what was stored, and mend what can be mended", "upkeep"};
inline constexpr VerbElsewhere kMigrateStoreVerb{
    "migrate-store", "Copy a store from SQLite to PostgreSQL, or back, with every id as it is", "upkeep"};
inline constexpr VerbElsewhere kUserVerb{
    "user", "Say who may log in at the reports of a rigcald on this machine, and as what", "upkeep"};
inline constexpr VerbElsewhere kTokenVerb{"token", "Give programs tokens for the reports of a rigcald on this machine",
                                          "upkeep"};
inline constexpr VerbElsewhere kIdentityVerb{
    "identity", "Make, revoke and list the identities of servers, robots and operators on DDS", "upkeep"};
inline constexpr VerbElsewhere kSupportBundleVerb{
    "support-bundle", "Pack what somebody needs who helps with a rigcald on this machine, without secrets", "upkeep"};
// In those programs.
void AddSimulate(CLI::App& app, Context& context);
void AddCheck(CLI::App& app, Context& context);
void AddCompanion(CLI::App& app, Context& context);
void AddImport(CLI::App& app, Context& context);  // pushes bags, too
void AddRecord(CLI::App& app, Context& context);
void AddReplay(CLI::App& app, Context& context);
void AddCertificate(CLI::App& app, Context& context);
void AddBackup(CLI::App& app, Context& context);
void AddRestoreBackup(CLI::App& app, Context& context);
void AddFsck(CLI::App& app, Context& context);
void AddMigrateStore(CLI::App& app, Context& context);
void AddUser(CLI::App& app, Context& context);
void AddToken(CLI::App& app, Context& context);
void AddIdentity(CLI::App& app, Context& context);
void AddSupportBundle(CLI::App& app, Context& context);
// In `rigcal`: starts the program, if it is installed beside.
void AddElsewhere(CLI::App& app, Context& context, const VerbElsewhere& verb);
template <const VerbElsewhere& kVerb>
void AddElsewhere(CLI::App& app, Context& context) {
  AddElsewhere(app, context, kVerb);
}

}  // namespace rigcal::client

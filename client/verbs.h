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
void AddModel(CLI::App& app, Context& context);   // rig models: show, list, check, set
void AddFleet(CLI::App& app, Context& context);   // how sensors sit on the robots of a rig model
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
// In programs of their own (simulate_main.cc, check_main.cc, companion_main.cc, upkeep_main.cc, import_main.cc, which pushes bags, records and replays too); `rigcal` has those
// that start them.
inline constexpr const char* kSimulateDescription = "Write the session of a virtual robot, with its truth";
inline constexpr const char* kCheckDescription = "Say whether a session folder will do, and what to take more of";
inline constexpr const char* kCompanionDescription = "Say where to hold the board next, while a session is taken";
inline constexpr const char* kImportDescription = "Make a session folder of a bag, or say what is in the bag";
inline constexpr const char* kBackupDescription = "Copy the data folder of a rigcald on this machine, while it serves";
inline constexpr const char* kRestoreBackupDescription = "Make a data folder of a backup";
inline constexpr const char* kFsckDescription = "Say whether a data folder is what was stored, and mend what can be mended";
inline constexpr const char* kUserDescription = "Say who may log in at the reports of a rigcald on this machine, and as what";
inline constexpr const char* kTokenDescription = "Give programs tokens for the reports of a rigcald on this machine";
inline constexpr const char* kRecordDescription = "Record a session, or a bag, from the live topics of a ROS 2 robot";
inline constexpr const char* kReplayDescription = "Publish a bag as the topics of a ROS 2 robot, at its pace";
// Those that do it, and those that start the program that does, if it is installed beside.
void AddSimulate(CLI::App& app, Context& context);
void AddSimulateElsewhere(CLI::App& app, Context& context);
void AddCheck(CLI::App& app, Context& context);
void AddCheckElsewhere(CLI::App& app, Context& context);
void AddCompanion(CLI::App& app, Context& context);
void AddCompanionElsewhere(CLI::App& app, Context& context);
void AddImport(CLI::App& app, Context& context);
void AddImportElsewhere(CLI::App& app, Context& context);
// All five are of the program `rigcal-upkeep` (upkeep_main.cc).
void AddBackup(CLI::App& app, Context& context);
void AddBackupElsewhere(CLI::App& app, Context& context);
void AddRestoreBackup(CLI::App& app, Context& context);
void AddRestoreBackupElsewhere(CLI::App& app, Context& context);
void AddFsck(CLI::App& app, Context& context);
void AddFsckElsewhere(CLI::App& app, Context& context);
void AddUser(CLI::App& app, Context& context);
void AddUserElsewhere(CLI::App& app, Context& context);
void AddToken(CLI::App& app, Context& context);
void AddTokenElsewhere(CLI::App& app, Context& context);
void AddRecord(CLI::App& app, Context& context);
void AddRecordElsewhere(CLI::App& app, Context& context);
void AddReplay(CLI::App& app, Context& context);
void AddReplayElsewhere(CLI::App& app, Context& context);

}  // namespace rigcal::client

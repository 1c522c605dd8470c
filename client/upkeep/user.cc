#include <CLI/CLI.hpp>
#include <memory>

#include "client/text/document.h"
#include "client/upkeep/access_options.h"
#include "client/upkeep/own_store.h"
#include "client/upkeep/typed_password.h"
#include "client/verbs.h"
#include "server/base/digests/password.h"
#include "storage/access/accounts.h"

namespace rigcal::client {
namespace {

Result<std::string> AskHash(const std::string& name, const Context& context) {
  RIGCAL_ASSIGN(const std::string password, AskPassword(name, context.err));
  return HashOfPassword(password);
}

Status LetUserIn(const Context& context, const AccessWords& words) {
  RIGCAL_TRY(CheckName("user name", words.name));
  RIGCAL_ASSIGN(const Role role, RoleOf(words.role));
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_ASSIGN(const bool is_first, storage::HasAccounts(store));
  RIGCAL_ASSIGN(const std::string hash, AskHash(words.name, context));
  RIGCAL_TRY(storage::AddAccount(store, {0, words.name, role, hash, WordOf(words.who)}));
  SayDone(context, words, NameOf(role), "Added user " + words.name + " as " + NameOf(role) + ".");
  if (!is_first) context.err << "From now on nobody reads this server's pages without a login." << std::endl;
  return {};
}

Status ChangePassword(const Context& context, const AccessWords& words) {
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_ASSIGN(const std::string hash, AskHash(words.name, context));
  RIGCAL_ASSIGN(const Account changed, storage::ChangeAccount(store, words.name, {{}, hash}, WordOf(words.who)));
  SayDone(context, words, NameOf(changed.role),
          "User " + words.name + " has another password; where it was logged in, it is so no longer.");
  return {};
}

Status ChangeRole(const Context& context, const AccessWords& words) {
  RIGCAL_ASSIGN(const Role role, RoleOf(words.role));
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_TRY(storage::ChangeAccount(store, words.name, {role, {}}, WordOf(words.who)));
  SayDone(context, words, NameOf(role), "User " + words.name + " is " + NameOf(role) + " now, and logs in again.");
  return {};
}

Status RemoveUser(const Context& context, const AccessWords& words) {
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_TRY(storage::RemoveAccount(store, words.name, WordOf(words.who)));
  SayDone(context, words, "", "Removed user " + words.name + ", and whatever it was logged in at.");
  RIGCAL_ASSIGN(const bool are_left, storage::HasAccounts(store));
  if (!are_left) context.err << "There is no user any more: this server's pages need no login." << std::endl;
  return {};
}

Status ListUsers(const Context& context, const AccessWords& words) {
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_ASSIGN(const auto accounts, storage::LoadAccounts(store));
  std::vector<AccessRow> rows;
  for (const Account& one : accounts) rows.push_back({one.name, NameOf(one.role), one.word});
  PrintAccess(context, "users", "There is no user: this server's pages need no login.", rows);
  return {};
}

}  // namespace

void AddUser(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kUserVerb.name, kUserVerb.description);
  auto words = std::make_shared<AccessWords>();
  AddAccessAct(*verb, {"add", "Let somebody log in; asks for the password", true, true}, words, context, LetUserIn);
  AddAccessAct(*verb, {"password", "Give somebody another password; asks for it", true, false}, words, context,
               ChangePassword);
  AddAccessAct(*verb, {"role", "Give somebody another role", true, true}, words, context, ChangeRole);
  AddAccessAct(*verb, {"remove", "Let somebody log in no longer", true, false}, words, context, RemoveUser);
  AddAccessAct(*verb, {"list", "Who may log in, as what, since when", false, false}, words, context, ListUsers);
  verb->require_subcommand(1);
  verb->footer(
      "Runs on the server's machine, as the user whose folder it is; the rigcald may serve meanwhile, and knows at "
      "once. As long as\n"
      "there is a user, pages and answers over HTTP need a login or a token. Roles: viewer reads; technician retires, "
      "restores,\n"
      "begins epochs; approver approves, rejects, rolls back; admin sets policies and rig models; each may what those "
      "before it\n"
      "may. A password is asked for, or read as one line from standard input. Each change is in the audit.\n"
      "Exit code: 0 done, 4 refused.\n"
      "Examples:\n"
      "  rigcal user add ada --role approver\n"
      "  sudo -u rigcal rigcal user add ada --role admin --data /var/lib/rigcal\n"
      "  rigcal user password ada < password.txt\n"
      "  rigcal user list\n");
}

}  // namespace rigcal::client

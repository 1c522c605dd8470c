#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>

#include "client/identity/authority.h"
#include "client/text/document.h"
#include "client/text/table.h"
#include "client/upkeep/options.h"
#include "client/verbs.h"
#include "server/base/files/private_files.h"

namespace rigcal::client {
namespace {

constexpr double kDay_ns = 86'400e9;

struct IdentityWords {
  std::string folder, holder, name, role = NameOf(Role::kApprover);
  double days = 365.0;
  bool renews = false;
};
using Words = std::shared_ptr<IdentityWords>;

std::string DefaultAuthority() {
  const char* const home = std::getenv("HOME");
  return home == nullptr ? "rigcal-identities" : std::string(home) + "/.local/share/rigcal-identities";
}

std::string StateOf(const IssuedIdentity& one, Stamp now) {
  if (one.revoked) return "revoked";
  return one.identity.not_after <= now ? "expired" : "good";
}

std::string RoleText(const DdsIdentity& identity) {
  return identity.holder == IdentityHolder::kOperator ? NameOf(identity.role) : "";
}

std::string RowOf(const IssuedIdentity& one, Stamp now) {
  return JsonObject({{"holder", NameOf(one.identity.holder)},
                     {"name", one.identity.name},
                     {"role", RoleText(one.identity)},
                     {"serial", one.identity.serial},
                     {"state", StateOf(one, now)},
                     {"until", ToIso(one.identity.not_after)}});
}

void SayMade(const Context& context, const Authority& authority, const DdsIdentity& made) {
  const std::string folder = authority.FolderOf(made.holder, made.name).string();
  if (context.json) {
    context.out << JsonObject({{"folder", folder},
                               {"holder", NameOf(made.holder)},
                               {"name", made.name},
                               {"role", RoleText(made)},
                               {"serial", made.serial},
                               {"until", ToIso(made.not_after)}})
                << std::endl;
    return;
  }
  context.out << "The identity of " << TextOf(made) << " is good until " << ToIso(made.not_after) << ": " << folder
              << "\nTake that folder to its machine, for its user alone; there give it as --dds-identity or "
                 "RIGCAL_DDS_IDENTITY."
              << std::endl;
}

Status InitAuthority(const Context& context, const IdentityWords& words) {
  RIGCAL_ASSIGN(const Authority made, Authority::Make(words.folder, SystemClock().Now()));
  RIGCAL_ASSIGN(const auto issued, made.List());
  SayMade(context, made, issued.front().identity);
  context.err << words.folder << "/*.key make identities: keep them, and a copy, where no robot reaches them."
              << std::endl;
  return {};
}

Status NewIdentity(const Context& context, const IdentityWords& words) {
  RIGCAL_ASSIGN(Authority authority, Authority::Open(words.folder));
  RIGCAL_ASSIGN(const IdentityHolder holder, IdentityHolderOf(words.holder));
  RIGCAL_ASSIGN(const Role role, RoleOf(words.role));
  const Stamp now = SystemClock().Now();
  const Stamp until{now.ns + static_cast<std::int64_t>(words.days * kDay_ns)};
  RIGCAL_ASSIGN(const DdsIdentity made, authority.Issue(holder, words.name, now, until, words.renews, role));
  SayMade(context, authority, made);
  return {};
}

Status RevokeIdentity(const Context& context, const IdentityWords& words) {
  RIGCAL_ASSIGN(Authority authority, Authority::Open(words.folder));
  RIGCAL_ASSIGN(const IdentityHolder holder, IdentityHolderOf(words.holder));
  RIGCAL_ASSIGN(const int count, authority.Revoke(holder, words.name, SystemClock().Now()));
  if (context.json)
    context.out << JsonObject({{"holder", words.holder}, {"name", words.name}, {"revoked", std::int64_t{count}}})
                << std::endl;
  else
    context.out << (count == 0 ? "It was revoked before. " : "Revoked. ") << "Copy " << words.folder
                << "/server/revoked.crl to where the server's identity is: it lets them in no "
                << "longer from a few seconds later on." << std::endl;
  return {};
}

Status ListIdentities(const Context& context, const IdentityWords& words) {
  RIGCAL_ASSIGN(const Authority authority, Authority::Open(words.folder));
  RIGCAL_ASSIGN(const auto issued, authority.List());
  const Stamp now = SystemClock().Now();
  if (context.json) {
    std::string list;
    for (const IssuedIdentity& one : issued) list += (list.empty() ? "" : ",") + RowOf(one, now);
    context.out << JsonObject({Field::Raw("identities", "[" + list + "]")}) << std::endl;
    return {};
  }
  Table table({{"IDENTITY"}, {"STATE"}, {"UNTIL"}, {"SERIAL"}});
  for (const IssuedIdentity& one : issued)
    table.Add({TextOf(one.identity), StateOf(one, now), ToIso(one.identity.not_after), one.identity.serial});
  table.Print(context.out);
  return {};
}

using Act = Status (*)(const Context&, const IdentityWords&);

CLI::App* AddAct(CLI::App& verb, const char* name, const char* description, const Words& words, Context& context,
                 Act run) {
  CLI::App* const act = verb.add_subcommand(name, description);
  act->add_option("--authority", words->folder, "Folder of the authority")->type_name("DIR")->capture_default_str();
  act->callback([&context, words, run] {
    MakePrivateFiles();
    const Status done = run(context, *words);
    if (!done) context.exit_code = Report(done.error(), context);
  });
  return act;
}

void AddWhose(CLI::App& act, const Words& words) {
  act.add_option("KIND", words->holder, "server, robot or operator")
      ->required()
      ->check(CLI::IsMember({"server", "robot", "operator"}));
  act.add_option("NAME", words->name, "The robot's id, or a person; of a server `rigcald`")->required();
}

}  // namespace

void AddIdentity(CLI::App& app, Context& context) {
  CLI::App* const verb = app.add_subcommand(kIdentityVerb.name, kIdentityVerb.description);
  const auto words = std::make_shared<IdentityWords>();
  words->folder = DefaultAuthority();
  AddAct(*verb, "init", "Make the authority, and the identity of a server", words, context, InitAuthority);
  CLI::App* const make =
      AddAct(*verb, "new", "Make one, in a folder to take to its machine", words, context, NewIdentity);
  AddWhose(*make, words);
  make->add_option("--days", words->days, "How long it is good")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 36'500.0));
  make->add_option("--role", words->role, "Of an operator: viewer, technician, approver or admin")
      ->type_name("ROLE")
      ->capture_default_str()
      ->check(CLI::IsMember({"viewer", "technician", "approver", "admin"}));
  make->add_flag("--renew", words->renews, "Although there is one that is good, which stays so until its date");
  AddWhose(*AddAct(*verb, "revoke", "Let one in no longer", words, context, RevokeIdentity), words);
  AddAct(*verb, "list", "All that were made, and until when they are good", words, context, ListIdentities);
  verb->require_subcommand(1);
  verb->footer(
      "Who has an identity proves it on DDS, and all of it is encrypted: a robot writes and reads of itself only, an\n"
      "operator pushes for robots and gives orders under that name, and nobody else sees or writes anything\n"
      "(docs/operations.md). The server and all others take part with identities of the same authority, or nobody "
      "does.\n"
      "Exit code: 0 done, 4 refused.\n"
      "Examples:\n"
      "  rigcal identity init\n"
      "  rigcal identity new robot mapper-01\n"
      "  rigcal identity new operator ada --role approver --days 90\n"
      "  rigcal identity new operator ben --role technician\n"
      "  rigcal identity revoke robot mapper-01\n"
      "  rigcal identity list\n"
      "  rigcal push visit/ --dds-identity /etc/rigcal/dds\n");
}

}  // namespace rigcal::client

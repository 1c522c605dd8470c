#include <CLI/CLI.hpp>
#include <memory>

#include "client/text/document.h"
#include "client/upkeep/access_options.h"
#include "client/upkeep/own_store.h"
#include "client/verbs.h"
#include "server/base/digests/secret.h"
#include "server/base/digests/sha256.h"
#include "server/base/site_robots.h"
#include "storage/access/access_tokens.h"

namespace rigcal::client {
namespace {

// Told once: kept is its digest alone.
Status NewToken(const Context& context, const AccessWords& words) {
  const bool is_site = words.role == kSiteRole;
  if (!is_site && !words.robots.empty())
    return Fail(ErrorCode::kInvalidInput, "--robots is of the role site, and this token is for " + words.role,
                "Leave it out: who reads sees every robot.");
  RIGCAL_ASSIGN(const Role role, is_site ? Result<Role>(Role::kViewer) : RoleOf(words.role));
  const std::string robots = is_site && words.robots.empty() ? "*" : words.robots;
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  const std::string secret = NewSecret();
  RIGCAL_TRY(storage::AddAccessToken(store, {0, words.name, role, Sha256Of(secret), WordOf(words.who), robots}));
  if (context.json) {
    context.out << JsonObject({{"name", words.name}, {"role", words.role}, {"token", secret}}) << std::endl;
    return {};
  }
  context.out << secret << std::endl;
  context.err << "The token of " << words.name << ", as " << words.role
              << ": it is not shown again. A program sends it as `Authorization: Bearer TOKEN`." << std::endl;
  return {};
}

Status RevokeToken(const Context& context, const AccessWords& words) {
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_TRY(storage::RevokeAccessToken(store, words.name, WordOf(words.who)));
  SayDone(context, words, "", "The token of " + words.name + " is good no longer.");
  return {};
}

Status ListTokens(const Context& context, const AccessWords& words) {
  RIGCAL_ASSIGN(storage::Store store, OpenOwnStore(words.data, context.err));
  RIGCAL_ASSIGN(const auto tokens, storage::LoadAccessTokens(store));
  std::vector<AccessRow> rows;
  for (const AccessToken& one : tokens)
    rows.push_back({one.name, one.is_site() ? std::string(kSiteRole) : NameOf(one.role), one.word});
  PrintAccess(context, "tokens", "No program has a token.", rows);
  return {};
}

}  // namespace

void AddToken(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kTokenVerb.name, kTokenVerb.description);
  auto words = std::make_shared<AccessWords>();
  AddAccessAct(*verb, {"new", "Make one, and print it this once", true, true, true}, words, context, NewToken);
  AddAccessAct(*verb, {"revoke", "Let a program in no longer", true, false}, words, context, RevokeToken);
  AddAccessAct(*verb, {"list", "Which are good, as what, since when", false, false}, words, context, ListTokens);
  verb->require_subcommand(1);
  verb->footer(
      "Runs on the server's machine, as the user whose folder it is. A program with a token needs no login; roles are "
      "those of\n"
      "`rigcal user`. Each change is in the audit, and so is what a program does, under its name.\n"
      "Exit code: 0 done, 4 refused.\n"
      "Examples:\n"
      "  rigcal token new grafana --role viewer > grafana.token\n"
      "  rigcal token new harbour --role site --robots 'harbour-*' > harbour.token\n"
      "  rigcal token revoke grafana\n"
      "  rigcal token list\n");
}

}  // namespace rigcal::client

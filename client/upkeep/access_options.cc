#include "client/upkeep/access_options.h"

#include <CLI/CLI.hpp>

#include "client/named.h"
#include "client/text/document.h"
#include "client/text/table.h"
#include "client/upkeep/options.h"
#include "server/base/site_robots.h"

namespace rigcal::client {
namespace {

void AddRole(CLI::App& act_of, const AccessAct& act, const std::shared_ptr<AccessWords>& words) {
  std::vector<std::string> roles;
  for (const Role role : kRoles) roles.push_back(NameOf(role));
  if (act.of_program) roles.emplace_back(kSiteRole);
  act_of
      .add_option(
          "--role", words->role,
          std::string("viewer, technician, approver or admin") +
              (act.of_program ? "; or site: it sends on what robots pushed there, and may do nothing else" : ""))
      ->required()
      ->type_name("ROLE")
      ->check(CLI::IsMember(roles));
  if (!act.of_program) return;
  act_of
      .add_option("--robots", words->robots,
                  "Of a site: its robots, with commas between; a name may end in * (default: *, every robot)")
      ->type_name("NAMES");
}

}  // namespace

void AddAccessAct(CLI::App& verb, const AccessAct& act, const std::shared_ptr<AccessWords>& words, Context& context,
                  Status (*run)(const Context&, const AccessWords&)) {
  CLI::App* const one = verb.add_subcommand(act.name, act.description);
  words->data = DefaultDataFolder();
  if (act.of_one) one->add_option("NAME", words->name, "Whose")->required();
  if (act.as_role) AddRole(*one, act, words);
  if (act.of_one)
    one->add_option("--by", words->who, "Who does it, for the audit (default: the login name)")
        ->check(Named())
        ->type_name("WHO");
  one->add_option("--data", words->data, "Data folder of the rigcald, on this machine")
      ->type_name("DIR")
      ->capture_default_str();
  one->callback([&context, words, run] {
    const Status done = run(context, *words);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

void SayDone(const Context& context, const AccessWords& words, const std::string& role, const std::string& sentence) {
  if (!context.json) {
    context.out << sentence << std::endl;
    return;
  }
  const Field as = role.empty() ? Field::Raw("role", "null") : Field("role", role);
  context.out << JsonObject({{"name", words.name}, as}) << std::endl;
}

namespace {

void PrintRows(const std::vector<AccessRow>& rows, std::ostream& out) {
  Table table({{"NAME"}, {"ROLE"}, {"SINCE"}, {"BY"}});
  for (const AccessRow& row : rows) table.Add({row.name, row.role, ToIso(row.word.at), row.word.who});
  table.Print(out);
}

}  // namespace

void PrintAccess(const Context& context, const std::string& what, const std::string& none,
                 const std::vector<AccessRow>& rows) {
  if (!context.json) {
    rows.empty() ? void(context.out << none << "\n") : PrintRows(rows, context.out);
    return;
  }
  std::string list;
  for (const AccessRow& row : rows)
    list += (list.empty() ? "" : ",") +
            JsonObject({{"at", ToIso(row.word.at)}, {"name", row.name}, {"role", row.role}, {"who", row.word.who}});
  context.out << JsonObject({Field::Raw(what, "[" + list + "]")}) << std::endl;
}

}  // namespace rigcal::client

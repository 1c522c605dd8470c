// What `rigcal user` and `rigcal token` share: their words, how an act is added, what is printed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/verb.h"
#include "server/base/role.h"
#include "server/model/approval/standing.h"

namespace CLI {
class App;
}

namespace rigcal::client {

struct AccessWords {
  std::string name, role, who, data;
  std::string robots;  // of the token of a site
};
// "add", "remove", ...: `of_one`: takes NAME; `as_role`: takes --role.
struct AccessAct {
  std::string name, description;
  bool of_one = false, as_role = false;
  bool of_program = false;  // there is a role that no person has
};
// The act as a word behind the verb; `run` is told its words, and what it returns is reported.
void AddAccessAct(CLI::App& verb, const AccessAct& act, const std::shared_ptr<AccessWords>& words, Context& context,
                  Status (*run)(const Context&, const AccessWords&));

// One sentence, or the name and the role as JSON; an empty role is null.
void SayDone(const Context& context, const AccessWords& words, const std::string& role, const std::string& sentence);

struct AccessRow {
  std::string name;
  std::string role;
  Word word;
};
// A table, or {"`what`": [{at, name, role, who}]}; `none` where there is no row.
void PrintAccess(const Context& context, const std::string& what, const std::string& none,
                 const std::vector<AccessRow>& rows);

}  // namespace rigcal::client

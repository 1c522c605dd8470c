// Who asks, and whether they may: looked at before anything is answered.
#pragma once

#include <civetweb.h>

#include <optional>
#include <string>

#include "server/http/logins/logins.h"

namespace rigcal::http {

// What is known of whoever sent the request that is answered.
struct Visit {
  bool needs_login = false;      // there are people who may log in, and nobody else may read
  std::optional<Person> person;  // who it is; nobody of what is for everybody
  bool is_program = false;       // it came with a token: no browser sends one by itself
};

// Whether logins are needed now.
[[nodiscard]] Result<bool> AreLoginsNeeded(const Logins& logins);
// "/healthz", "/readyz", the style sheet of the login page.
[[nodiscard]] bool IsForEverybody(const std::string& path);
// Where logins are needed. `path` as NormalPath() gives it. Answers /login, /logout and whoever may not come in: the
// status; nothing: go on, `visit` says who it is.
[[nodiscard]] std::optional<int> Admit(mg_connection* connection, const std::string& path, Visit& visit);

// Whose request it is, until another is set; null at first.
void SetVisit(mg_connection* connection, const Visit* visit);
[[nodiscard]] const Visit* VisitOf(const mg_connection* connection);

}  // namespace rigcal::http

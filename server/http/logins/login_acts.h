// Logging in and out: /login and /logout.
#pragma once

#include <civetweb.h>

#include <string>

#include "server/http/logins/entrance.h"

namespace rigcal::http {

// The secret of the session that the browser has; empty: none.
[[nodiscard]] std::string SessionSecretOf(const mg_connection* connection);
// Whether the request was sent from a page of this server, as the browser says.
[[nodiscard]] bool IsFromHere(const mg_connection* connection);
// Whether `token` is that of the forms of the session that the browser has.
[[nodiscard]] bool HasFormToken(const mg_connection* connection, const std::string& token);

// GET shows the form, or who is logged in; POST logs in: with a new secret, whatever the browser came with, and the
// session of before is over. Returns the status.
int AnswerLogin(mg_connection* connection, const Visit& visit);
// POST logs out.
int AnswerLogout(mg_connection* connection, const Visit& visit);

}  // namespace rigcal::http

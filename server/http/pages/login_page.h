// The page where people log in and out. Pure; works without scripts.
#pragma once

#include <string>

#include "server/http/logins/logins.h"

namespace rigcal::http {

struct LoginPage {
  std::string form_token;     // comes back with the form
  std::string next = "/";     // where to go afterwards
  std::string name;           // as it was typed
  std::string what_is_wrong;  // a sentence; empty at first
};
[[nodiscard]] std::string WriteLoginPage(const LoginPage& page);
// Of somebody who is logged in: who, as what, and how to log out.
[[nodiscard]] std::string WriteAccountPage(const Person& person, const std::string& form_token);
// What stands at the head of pages that are made for whoever is logged in.
[[nodiscard]] std::string PersonNotice(const Person& person);

}  // namespace rigcal::http

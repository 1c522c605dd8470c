// Who may use the server over HTTP: people with passwords, programs with tokens.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/ids.h"
#include "server/base/role.h"
#include "server/model/approval/standing.h"

namespace rigcal {

struct Account {
  std::int64_t number = 0;  // another one with each change: what was begun with an older one is over
  std::string name;         // as CheckName() allows
  Role role = Role::kViewer;
  std::string password_hash;  // base/digests/password.h
  Word word;                  // when and by whom it was changed last
};

struct AccessToken {
  std::int64_t number = 0;
  std::string name;  // of the program; of tokens that are good, one has it
  Role role = Role::kViewer;
  Digest digest;  // of the secret: that itself is kept nowhere
  Word word;
  // Of the server of a site: which robots it may send on (base/site_robots.h). It may do nothing else, whatever `role`
  // says.
  std::string robots = {};
  [[nodiscard]] bool is_site() const { return !robots.empty(); }
};

}  // namespace rigcal

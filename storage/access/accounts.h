// People who may log in. Who has which role since when, and by whom, is append-only and in the audit; a password that
// is replaced or whose account is removed is gone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/access/account.h"
#include "storage/store.h"

namespace rigcal::storage {

// kInvalidInput where the name is none (CheckName, and CheckPerson of model/approval/decision.h) or a text of `word` is
// none, kConflict where there is one of this name, or a good token has it. `number` is not looked at; the account as it
// is now.
[[nodiscard]] Result<Account> AddAccount(Store& store, const Account& account);
// Another role or password, of what is given. Whoever is logged in by this account is so no longer. kNotFound: there is
// none.
struct AccountChange {
  std::optional<Role> role = {};
  std::optional<std::string> password_hash = {};
};
[[nodiscard]] Result<Account> ChangeAccount(Store& store, const std::string& name, const AccountChange& change,
                                            const Word& word);
// Likewise.
[[nodiscard]] Status RemoveAccount(Store& store, const std::string& name, const Word& word);

// Of the accounts that there are; by name.
[[nodiscard]] Result<std::vector<Account>> LoadAccounts(Store& store);
[[nodiscard]] Result<std::optional<Account>> LoadAccount(Store& store, const std::string& name);
[[nodiscard]] Result<bool> HasAccounts(Store& store);

}  // namespace rigcal::storage

#include "storage/access/accounts.h"

#include "server/model/approval/decision.h"
#include "storage/access/access_tokens.h"
#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/sessions/standing.h"

namespace rigcal::storage {
namespace {

constexpr const char* kRemoved = "none";

const std::string kAccountRows =
    "SELECT a.number, a.name, a.role, p.password_hash, a.at_ns, a.who FROM login_password p JOIN account a ON a.number "
    "= "
    "(SELECT max(number) FROM account n WHERE n.name = p.name) ";

std::string AccountSubject(const std::string& name) { return "user " + name; }

Result<Account> AccountOf(const Query& query) {
  Account account;
  account.number = query.Int(0);
  account.name = query.Text(1);
  RIGCAL_ASSIGN(account.role, RoleOf(query.Text(2)));
  account.password_hash = query.Text(3);
  account.word = {query.Time(4), query.Text(5), ""};
  return account;
}

// The new row's number.
std::int64_t InsertAccount(Store& store, const std::string& name, const std::string& role, const Word& word) {
  Query(store, "DELETE FROM login_session WHERE account_number IN (SELECT number FROM account WHERE name = ?)")
      .Bind(name)
      .Run();
  Query insert(store, "INSERT INTO account (name, role, at_ns, who) VALUES (?, ?, ?, ?) RETURNING number");
  return insert.Bind(name, role, word.at, word.who).RunForKey().value();
}

// The newest row and the password.
Account Put(Store& store, Account account) {
  account.number = InsertAccount(store, account.name, NameOf(account.role), account.word);
  Query(store,
        "INSERT INTO login_password VALUES (?, ?) ON CONFLICT (name) DO UPDATE SET password_hash = "
        "excluded.password_hash")
      .Bind(account.name, account.password_hash)
      .Run();
  return account;
}

tl::unexpected<Error> NoSuchUser(const std::string& name) {
  return Fail(ErrorCode::kNotFound, "there is no user " + name, "`rigcal user list` names all of them.");
}

std::string WhatChanged(const Account& before, const AccountChange& change) {
  std::string text;
  if (change.password_hash) text = "gave user " + before.name + " another password";
  if (change.role)
    text += (text.empty() ? "made user " + before.name : " and made it") + " " + NameOf(*change.role) + ", before " +
            NameOf(before.role);
  return text;
}

}  // namespace

Result<Account> AddAccount(Store& store, const Account& account) {
  RIGCAL_TRY(CheckName("user name", account.name));
  RIGCAL_TRY(CheckPerson(account.name));
  RIGCAL_TRY(CheckWord(account.word));
  return Append<Account>(store, AccountSubject(account.name), [&]() -> Result<Account> {
    RIGCAL_ASSIGN(const auto before, LoadAccount(store, account.name));
    if (before)
      return Fail(ErrorCode::kConflict, "there is a user " + account.name + " already",
                  "`rigcal user password` and `rigcal user role` change it.");
    RIGCAL_ASSIGN(const bool is_token, HasAccessToken(store, account.name));
    if (is_token)
      return Fail(ErrorCode::kConflict,
                  account.name + " is the name of a token, and the audit could not tell it from a user",
                  "Take another name, or `rigcal token revoke " + account.name + "` first.");
    const Account added = Put(store, account);
    RIGCAL_TRY(AppendAudit(store, account.word.at, account.word.who,
                           "added user " + account.name + " as " + NameOf(account.role)));
    return added;
  });
}

Result<Account> ChangeAccount(Store& store, const std::string& name, const AccountChange& change, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return Append<Account>(store, AccountSubject(name), [&]() -> Result<Account> {
    RIGCAL_ASSIGN(const auto before, LoadAccount(store, name));
    if (!before) return NoSuchUser(name);
    const Account changed = Put(store, {0, name, change.role.value_or(before->role),
                                        change.password_hash.value_or(before->password_hash), word});
    RIGCAL_TRY(AppendAudit(store, word.at, word.who, WhatChanged(*before, change)));
    return changed;
  });
}

Status RemoveAccount(Store& store, const std::string& name, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return store.connection().Append(AccountSubject(name), [&]() -> Status {
    RIGCAL_ASSIGN(const auto before, LoadAccount(store, name));
    if (!before) return NoSuchUser(name);
    InsertAccount(store, name, kRemoved, word);
    Query(store, "DELETE FROM login_password WHERE name = ?").Bind(name).Run();
    return AppendAudit(store, word.at, word.who, "removed user " + name + ", who was " + NameOf(before->role));
  });
}

Result<std::vector<Account>> LoadAccounts(Store& store) {
  using Accounts = std::vector<Account>;
  return Load<Accounts>(store, "the users", [&]() -> Result<Accounts> {
    Query query(store, kAccountRows + "ORDER BY p.name");
    Accounts accounts;
    while (query.Step()) {
      RIGCAL_ASSIGN(Account account, AccountOf(query));
      accounts.push_back(std::move(account));
    }
    return accounts;
  });
}

Result<std::optional<Account>> LoadAccount(Store& store, const std::string& name) {
  using Found = std::optional<Account>;
  return Load<Found>(store, AccountSubject(name), [&]() -> Result<Found> {
    Query query(store, kAccountRows + "WHERE p.name = ?");
    if (!query.Bind(name).Step()) return Found();
    RIGCAL_ASSIGN(Account account, AccountOf(query));
    return Found(std::move(account));
  });
}

Result<bool> HasAccounts(Store& store) {
  return Load<bool>(store, "the users",
                    [&]() -> Result<bool> { return Query(store, "SELECT 1 FROM login_password LIMIT 1").Step(); });
}

}  // namespace rigcal::storage

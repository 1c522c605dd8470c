#include "storage/access/login_sessions.h"

#include "storage/access/accounts.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr const char* kLoginSubject = "who is logged in";
constexpr std::int64_t kNoteSeenEvery_ns = 300LL * 1'000'000'000;

struct LoginRow {
  Account account;
  Stamp began_at, seen_at;
};

// A clock that was set back makes no session older, nor younger than its beginning.
bool IsOver(const LoginRow& row, Stamp now) {
  return now.ns - row.seen_at.ns > kLoginIdle_ns || now.ns - row.began_at.ns > kLoginAge_ns;
}

void DeleteOver(Store& store, Stamp now) {
  Query(store, "DELETE FROM login_session WHERE seen_ns < ? OR began_ns < ?")
      .Bind(now.ns - kLoginIdle_ns, now.ns - kLoginAge_ns)
      .Run();
}

void DeleteBeyond(Store& store, std::int64_t account) {
  Query(store,
        "DELETE FROM login_session WHERE account_number = ?1 AND digest NOT IN (SELECT digest FROM login_session "
        "WHERE account_number = ?1 ORDER BY began_ns DESC, digest LIMIT ?2)")
      .Bind(account, kLoginsOfAccountMax)
      .Run();
}

Result<std::optional<LoginRow>> FindLogin(Store& store, const Digest& digest) {
  Query query(store,
              "SELECT a.number, a.name, a.role, s.began_ns, s.seen_ns FROM login_session s JOIN account a ON a.number "
              "= s.account_number "
              "WHERE s.digest = ? AND a.number = (SELECT max(number) FROM account n WHERE n.name = a.name)");
  if (!query.Bind(digest).Step()) return std::optional<LoginRow>();
  LoginRow row;
  row.account.number = query.Int(0);
  row.account.name = query.Text(1);
  RIGCAL_ASSIGN(row.account.role, RoleOf(query.Text(2)));
  row.began_at = query.Time(3);
  row.seen_at = query.Time(4);
  return std::optional(std::move(row));
}

// Whether it could be noted makes no difference to who asks.
void NoteSeen(Store& store, const Digest& digest, Stamp now) {
  (void)store.WriteSoon([&]() -> Status {
    return store.connection().Append(kLoginSubject, [&]() -> Status {
      Query(store, "UPDATE login_session SET seen_ns = ? WHERE digest = ?").Bind(now, digest).Run();
      return {};
    });
  });
}

}  // namespace

Status BeginLogin(Store& store, const Digest& digest, const Account& account, Stamp now) {
  return store.connection().Append(kLoginSubject, [&]() -> Status {
    RIGCAL_ASSIGN(const auto is, LoadAccount(store, account.name));
    if (!is || is->number != account.number)
      return Fail(ErrorCode::kConflict, "user " + account.name + " was changed meanwhile", "Log in again.");
    DeleteOver(store, now);
    Query(store, "INSERT INTO login_session VALUES (?, ?, ?, ?)").Bind(digest, account.number, now, now).Run();
    DeleteBeyond(store, account.number);
    return {};
  });
}

Result<std::optional<Account>> SeeLogin(Store& store, const Digest& digest, Stamp now) {
  using Found = std::optional<LoginRow>;
  RIGCAL_ASSIGN(const Found found, Load<Found>(store, kLoginSubject, [&] { return FindLogin(store, digest); }));
  if (!found || IsOver(*found, now)) return std::optional<Account>();
  if (now.ns - found->seen_at.ns > kNoteSeenEvery_ns) NoteSeen(store, digest, now);
  return std::optional(found->account);
}

Status EndLogin(Store& store, const Digest& digest) {
  return store.connection().Append(kLoginSubject, [&]() -> Status {
    Query(store, "DELETE FROM login_session WHERE digest = ?").Bind(digest).Run();
    return {};
  });
}

}  // namespace rigcal::storage

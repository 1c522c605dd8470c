#include "storage/access/access_tokens.h"

#include "server/base/site_robots.h"
#include "server/model/approval/decision.h"
#include "storage/access/accounts.h"
#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/sessions/standing.h"

namespace rigcal::storage {
namespace {

const std::string kGoodTokens =
    "SELECT number, name, role, digest, at_ns, who, (SELECT robots FROM access_token_site s WHERE s.token_number = "
    "t.number) FROM access_token t WHERE NOT EXISTS (SELECT 1 FROM access_token_revoked WHERE token_number = "
    "t.number) ";

std::string TokenSubject(const std::string& name) { return "the token of " + name; }

Result<AccessToken> TokenOf(const Query& query) {
  RIGCAL_ASSIGN(const Role role, RoleOf(query.Text(2)));
  return AccessToken{query.Int(0), query.Text(1), role, query.IdAt<Digest>(3), {query.Time(4), query.Text(5), ""},
                     query.Text(6)};
}

void InsertToken(Store& store, const AccessToken& token) {
  const auto number =
      Query(store, "INSERT INTO access_token (name, role, digest, at_ns, who) VALUES (?, ?, ?, ?, ?) RETURNING number")
          .Bind(token.name, NameOf(token.role), token.digest, token.word.at, token.word.who)
          .RunForKey();
  if (token.is_site()) Query(store, "INSERT INTO access_token_site VALUES (?, ?)").Bind(number, token.robots).Run();
}

// Of `sql` with one parameter.
Result<std::optional<AccessToken>> TokenBy(Store& store, const std::string& sql, const std::string& value) {
  using Found = std::optional<AccessToken>;
  return Load<Found>(store, "the tokens", [&]() -> Result<Found> {
    Query query(store, sql);
    if (!query.Bind(value).Step()) return Found();
    RIGCAL_ASSIGN(AccessToken token, TokenOf(query));
    return Found(std::move(token));
  });
}

Result<std::optional<AccessToken>> TokenByName(Store& store, const std::string& name) {
  return TokenBy(store, kGoodTokens + "AND name = ?", name);
}

}  // namespace

Status AddAccessToken(Store& store, const AccessToken& token) {
  RIGCAL_TRY(CheckName("token name", token.name));
  RIGCAL_TRY(CheckPerson(token.name));
  RIGCAL_TRY(CheckWord(token.word));
  if (token.is_site()) RIGCAL_TRY(CheckRobotNames(token.robots));
  return store.connection().Append(TokenSubject(token.name), [&]() -> Status {
    RIGCAL_ASSIGN(const auto before, TokenByName(store, token.name));
    if (before)
      return Fail(ErrorCode::kConflict, "there is a token of " + token.name + " already",
                  "Take another name, or `rigcal token revoke " + token.name + "` first.");
    RIGCAL_ASSIGN(const auto user, LoadAccount(store, token.name));
    if (user)
      return Fail(ErrorCode::kConflict, token.name + " is a user, and the audit could not tell it from a token",
                  "Take another name for the token.");
    InsertToken(store, token);
    const std::string as = token.is_site() ? std::string(kSiteRole) + " of robots " + token.robots : NameOf(token.role);
    return AppendAudit(store, token.word.at, token.word.who, "made a token for " + token.name + " as " + as);
  });
}

Status RevokeAccessToken(Store& store, const std::string& name, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return store.connection().Append(TokenSubject(name), [&]() -> Status {
    RIGCAL_ASSIGN(const auto token, TokenByName(store, name));
    if (!token)
      return Fail(ErrorCode::kNotFound, "no token of " + name + " is good", "`rigcal token list` names all that are.");
    Query(store, "INSERT INTO access_token_revoked VALUES (?, ?, ?)").Bind(token->number, word.at, word.who).Run();
    return AppendAudit(store, word.at, word.who, "revoked the token of " + name);
  });
}

Result<std::vector<AccessToken>> LoadAccessTokens(Store& store) {
  using Tokens = std::vector<AccessToken>;
  return Load<Tokens>(store, "the tokens", [&]() -> Result<Tokens> {
    Query query(store, kGoodTokens + "ORDER BY name");
    Tokens tokens;
    while (query.Step()) {
      RIGCAL_ASSIGN(AccessToken token, TokenOf(query));
      tokens.push_back(std::move(token));
    }
    return tokens;
  });
}

Result<bool> HasAccessToken(Store& store, const std::string& name) {
  RIGCAL_ASSIGN(const auto token, TokenByName(store, name));
  return token.has_value();
}

Result<std::optional<AccessToken>> LoadAccessToken(Store& store, const Digest& digest) {
  return TokenBy(store, kGoodTokens + "AND digest = ?", digest.str());
}

}  // namespace rigcal::storage

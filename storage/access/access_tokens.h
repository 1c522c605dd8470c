// Tokens of programs that may use the server over HTTP. Append-only and in the audit; of a secret only its digest is
// kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/access/account.h"
#include "storage/store.h"

namespace rigcal::storage {

// kInvalidInput where the name is none (CheckName, CheckPerson) or a text of `word` is none, kConflict where a token of
// this name is good, or a user has it: the audit could not tell them apart. `number` is not looked at.
[[nodiscard]] Status AddAccessToken(Store& store, const AccessToken& token);
// kNotFound: none of this name is good.
[[nodiscard]] Status RevokeAccessToken(Store& store, const std::string& name, const Word& word);
// Those that are good, by name.
[[nodiscard]] Result<std::vector<AccessToken>> LoadAccessTokens(Store& store);
[[nodiscard]] Result<bool> HasAccessToken(Store& store, const std::string& name);
// That of a secret with this digest, if it is good.
[[nodiscard]] Result<std::optional<AccessToken>> LoadAccessToken(Store& store, const Digest& digest);

}  // namespace rigcal::storage

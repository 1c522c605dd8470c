// Who is logged in. Of a session's secret only its digest is kept; sessions that are over are deleted.
#pragma once

#include <optional>

#include "server/model/access/account.h"
#include "storage/store.h"

namespace rigcal::storage {

inline constexpr std::int64_t kLoginIdle_ns = 12LL * 3600 * 1'000'000'000;      // unseen for longer it is over
inline constexpr std::int64_t kLoginAge_ns = 30LL * 24 * 3600 * 1'000'000'000;  // and so it is, however it is used
inline constexpr int kLoginsOfAccountMax = 64;                                  // one more ends that which began first

// kConflict where `account` is not as it is stored now: it was changed or removed meanwhile.
[[nodiscard]] Status BeginLogin(Store& store, const Digest& digest, const Account& account, Stamp now);
// Whose session it is, without a password; nothing where it is over or never was. That it was seen is noted, every few
// minutes, unless another has the database.
[[nodiscard]] Result<std::optional<Account>> SeeLogin(Store& store, const Digest& digest, Stamp now);
// No error where there is none.
[[nodiscard]] Status EndLogin(Store& store, const Digest& digest);

}  // namespace rigcal::storage

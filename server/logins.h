// The people and programs that the store knows, and what they ask to be changed, as HTTP asks about them.
#pragma once

#include "server/base/stamp.h"
#include "server/http/logins/logins.h"
#include "server/service_relay.h"
#include "storage/store_place.h"

namespace rigcal {

// `always`: logins are needed also while there is no user. At most two passwords are looked at at once, who comes
// meanwhile waits two seconds, then kBusy. `clock` outlives what is given.
[[nodiscard]] http::Logins LoginsOf(const storage::StorePlace& place, const Clock& clock, bool always);

// Orders are handed on to the service that `relay` reaches, with the name of whoever gives them as `who`: kInvalidInput
// where the order itself says another. `relay` outlives what is given.
[[nodiscard]] http::Orders OrdersTo(const ServiceRelay& relay);

}  // namespace rigcal

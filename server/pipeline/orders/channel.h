// Who gave an order that came by a way on which nobody is known.
#pragma once

#include <string>

#include "server/model/approval/order_origin.h"
#include "storage/store.h"

namespace rigcal::pipeline {

inline constexpr const char* kNotVerified = " (over DDS, not verified)";
inline constexpr const char* kVerified = " (over DDS, verified)";

// kInvalidInput, and a line in the log: it came with an identity whose role is not enough for `verb`. Over HTTP roles
// were looked at before; without identities nobody has one.
[[nodiscard]] Status CheckMayGive(const std::string& verb, const OrderOrigin& origin);

// The parameters of an order. Of one over DDS `who` says, in the audit and wherever else it is shown, that it is whose
// identity DDS verified; without identities, where there are users, that nobody verified it: anybody on the network can
// say any user's name. kInvalidInput where they are none, or name somebody else than who was verified.
[[nodiscard]] Result<std::string> WithChannel(storage::Store& store, const std::string& json,
                                              const OrderOrigin& origin);

}  // namespace rigcal::pipeline

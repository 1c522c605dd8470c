// Who gave an order that came by a way on which nobody is known.
#pragma once

#include <string>

#include "server/model/approval/order.h"
#include "storage/store.h"

namespace rigcal::pipeline {

inline constexpr const char* kNotVerified = " (over DDS, not verified)";

// The parameters of an order. Of one over DDS, where there are users, `who` says that nobody verified it, in the audit
// and wherever else it is shown: anybody on the network can say any user's name. kInvalidInput where they are none.
[[nodiscard]] Result<std::string> WithChannel(storage::Store& store, const std::string& json, OrderChannel channel);

}  // namespace rigcal::pipeline

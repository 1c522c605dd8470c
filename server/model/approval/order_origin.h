// Who gave an order, as far as anybody verified it.
#pragma once

#include <optional>
#include <string>

#include "server/base/role.h"
#include "server/model/approval/order.h"

namespace rigcal {

struct VerifiedPerson {
  std::string name;
  Role role = Role::kViewer;
};

struct OrderOrigin {
  OrderChannel channel = OrderChannel::kDds;
  std::optional<VerifiedPerson> verified = {};  // over DDS: whose identity it came with; nothing: nobody knows
};

}  // namespace rigcal

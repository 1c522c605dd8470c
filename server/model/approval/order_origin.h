// Who gave an order, as far as anybody verified it.
#pragma once

#include <string>

#include "server/model/approval/order.h"

namespace rigcal {

struct OrderOrigin {
  OrderChannel channel = OrderChannel::kDds;
  std::string verified = {};  // over DDS: whose identity it was; empty: nobody knows
};

}  // namespace rigcal

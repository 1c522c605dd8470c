// A verb that changes something: asks for it, says what came of it, waits for the revision that counts it.
#pragma once

#include <functional>
#include <string>

#include "client/verb.h"

namespace CLI {
class App;
}

namespace rigcal::client {

struct OrderOptions {
  std::string id, robot, who, reason;
  double give_up_s = 60.0;
  bool no_wait = false;
};
// Who works at this machine.
[[nodiscard]] std::string LoginName();
// Who gives an order: `given`, or else the operator whose identity RIGCAL_DDS_IDENTITY has, or else LoginName().
[[nodiscard]] std::string WhoAsks(const std::string& given);
// --by, --robot, --no-wait, --timeout-total.
void AddOrderOptions(CLI::App& verb, OrderOptions& options);

struct OrderToGive {
  std::string verb;
  std::function<void(const Document& done, std::ostream&)> print;
};
// What follows the answer `text` to an order: it is told, and the revision waited for. Sets the exit code by its
// verdict.
[[nodiscard]] Status FollowOrder(Context& context, const OrderToGive& order, const OrderOptions& options,
                                 const std::string& text);
// Asks for it first.
[[nodiscard]] Status GiveOrder(Context& context, const OrderToGive& order, const OrderOptions& options);

}  // namespace rigcal::client

// WRITE: what people ask to be changed: (verb, parameters) -> one transaction, then the document of docs/api.md.
#pragma once

#include <optional>
#include <string>

#include "server/base/role.h"
#include "server/base/stamp.h"
#include "server/model/approval/order.h"
#include "server/model/approval/order_origin.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Whether the verb changes what is stored: restore, retire, set_policy, set_rig_model, epoch, measure_board, resolve,
// and decisions.
[[nodiscard]] bool IsOrder(const std::string& verb);
// Who may give it over HTTP: approver what decides, admin what sets policies and rig models, technician the others;
// nothing: it is no order.
[[nodiscard]] std::optional<Role> RoleOfOrder(const std::string& verb);

// What it returns is durable. Carried out twice it is as if it was once, and answered alike. The thing is named as in
// robots/asked.h, besides `who` and `reason`.
// retire: the edge, the edges of the session, or those of the sensor take no part from now on, and of a sensor nothing
// that sessions say of it. kConflict for the reference, where no other sensor can take its place. Without `reason`
// kInvalidInput. restore: what was retired takes part again; a session is current, and those that it repeats or is
// repeated by are superseded by it. set_policy: policies.h. set_rig_model, epoch: rig_models/. measure_board:
// boards/registry.h. approve, reject, rollback: decide.h. resolve: recomputation/ask.h.
[[nodiscard]] Result<OrderDone> CarryOut(storage::Store& store, const Clock& clock, const std::string& verb,
                                         const std::string& json);

// Behind who gave an order over DDS, where nobody is known, or by an identity.
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

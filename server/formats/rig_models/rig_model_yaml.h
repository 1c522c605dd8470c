// A rig model as people write it (docs/rig-models.md).
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/robots/rig_model.h"

namespace rigcal::formats {

inline constexpr std::size_t kRigModelBytesMax = 32u << 10;  // as a policy: an order has room for it

// `name` starts every error: "mars.yaml line 3: sensor 'left': its pose has no tolerance". The reference, where none is
// named the first sensor without a pose, sits at the identity as soon as another sensor has a pose.
[[nodiscard]] Result<RigModel> ReadRigModel(std::string_view text, const std::string& name);

}  // namespace rigcal::formats

// The pages about rig models: a list of them, and how the sensors of one sit on its robots.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/robots/population.h"
#include "server/model/robots/rig_model.h"

namespace rigcal::report {

// The name as a folder of an address.
[[nodiscard]] std::string PathOfRigModel(const std::string& name);

struct RigModelLine {
  std::string name;
  std::int64_t version = 0;  // 0: nobody has set it
  std::int64_t robots = 0;
};
// /models/. In the order of `rows`; beyond a limit only how many there are is told.
[[nodiscard]] Result<std::string> RenderRigModels(const std::vector<RigModelLine>& rows);

// /models/NAME/: who stands out, then a card per sensor with a drawing of its six axes. `set` is absent where nobody
// has set the model.
[[nodiscard]] Result<std::string> RenderRigModel(const Population& population,
                                                 const std::optional<RigModelVersion>& set);

}  // namespace rigcal::report

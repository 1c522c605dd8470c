// Features by content: a picture is searched once, ever.
#pragma once

#include <optional>
#include <string>

#include "server/model/sensors/features.h"
#include "storage/store.h"

namespace rigcal::storage {

struct StoredView {
  BoardView view;
  Digest picture;  // annotated picture in the blob store; empty if there is none
};
// `detector` names algorithm, its version and the target's geometry.
[[nodiscard]] Result<std::optional<StoredView>> LoadView(Store& store, const Digest& image,
                                                         const std::string& detector);
// Whether the target was found in the picture, by this detector or by an earlier one; nothing: none could look.
[[nodiscard]] Result<std::optional<bool>> WasFound(Store& store, const Digest& image, const std::string& detector,
                                                   const TargetId& target);
[[nodiscard]] Status AppendView(Store& store, const Digest& image, const std::string& detector, const StoredView& view);

struct StoredCloud {
  CloudView view;
  Digest picture;  // as above
};
// As of pictures: nothing if this detector has not seen the cloud yet; a cloud that is there already stays as it is.
[[nodiscard]] Result<std::optional<StoredCloud>> LoadCloud(Store& store, const Digest& cloud,
                                                           const std::string& detector);
[[nodiscard]] Status AppendCloud(Store& store, const Digest& cloud, const std::string& detector,
                                 const StoredCloud& stored);

}  // namespace rigcal::storage

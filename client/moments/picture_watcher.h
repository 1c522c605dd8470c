// Watches the pictures of one camera one after the other: the board is searched now and then, and followed in between.
#pragma once

#include <memory>
#include <vector>

#include "client/moments/sight.h"
#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::moments {

// One thread at a time. Deterministic: the same pictures and stamps give the same sights.
class PictureWatcher {
 public:
  // Those that the camera may see; they outlive it.
  explicit PictureWatcher(std::vector<const Target*> targets);
  ~PictureWatcher();
  PictureWatcher(PictureWatcher&&) noexcept;
  PictureWatcher& operator=(PictureWatcher&&) = delete;

  // Of the next picture. A board that was found is followed by its corners (Lucas & Kanade 1981, pyramids, there and
  // back), each set on its saddle again, and searched anew every second, or where one was lost. While none is in view
  // it is searched five times a second. Throws std::bad_alloc.
  [[nodiscard]] Sight Look(detect::GreyImage image, std::int64_t stamp_ns);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rigcal::moments

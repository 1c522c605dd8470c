// What decoding takes of the memory that the process sets aside for it, by headers alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/process/memory_budget.h"
#include "server/model/sessions/session.h"
#include "storage/files/blobs.h"

namespace rigcal::pipeline {

struct Needed {
  std::int64_t bytes = 0;
  std::string of;  // 'file "left/01.png" of 14000 x 14000 pixels'
};
// To search a target in it, with its encoded bytes. What the header does not tell, the decoder refuses.
[[nodiscard]] Needed ToSearchPicture(const storage::Blobs& blobs, const Payload& picture, const Target& target);
[[nodiscard]] Needed ToSearchCloud(const storage::Blobs& blobs, const Payload& cloud, const Target& target);
// To register the clouds of two lidars, all held at once.
[[nodiscard]] Needed ToRegister(const storage::Blobs& blobs, const std::vector<const Payload*>& clouds);
// To colour a cloud from pictures of which one is in memory at a time.
[[nodiscard]] Needed ToColour(const storage::Blobs& blobs, const Payload& cloud,
                              const std::vector<const Payload*>& pictures);

// More than the process ever has for it: why, and what to do.
[[nodiscard]] std::optional<Error> TooLarge(const Needed& needed);
// Waits for it, in turn (MemoryBudget::Take).
[[nodiscard]] Result<MemoryBudget::Share> TakeMemory(const Needed& needed);

}  // namespace rigcal::pipeline

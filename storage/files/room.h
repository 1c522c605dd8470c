// Room on the disk of a store.
#pragma once

#include <cstdint>
#include <filesystem>

#include "server/base/result.h"

namespace rigcal::storage {

// Can something be stored? Writes a small file and removes it, without waiting for the disk: well below a millisecond.
// kStorage names the disk and why not: it is full, read-only, gone. Else the free bytes.
[[nodiscard]] Result<std::int64_t> ProbeRoom(const std::filesystem::path& folder);

// Hardly anything is free on the disk.
[[nodiscard]] bool IsFull(const std::filesystem::path& folder);

// To open a store, even only to read it, SQLite needs 32 KiB for the index of its log. So some room is kept for when
// the disk is full: `folder`/reserve. Grows it to its size where the disk has that much to spare.
void KeepReserve(const std::filesystem::path& folder);
// If the disk is full, gives it back a part of the reserve; false if it is not full or nothing is left.
[[nodiscard]] bool SpendReserve(const std::filesystem::path& folder);

}  // namespace rigcal::storage

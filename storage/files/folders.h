// The folders of a store, and who has it open. For storage/*.cc only.
#pragma once

#include <filesystem>

#include "server/base/files/file_descriptor.h"
#include "server/base/result.h"

namespace rigcal::storage {

// Where the parts of the store at `folder` lie; nothing is looked at.
[[nodiscard]] std::filesystem::path DatabaseFile(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path BlobFolderOf(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path IntakeFolderOf(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path ReportFolderOf(const std::filesystem::path& folder);
// The file that is there while another store is being copied into `folder`.
[[nodiscard]] std::filesystem::path UnfinishedMarkOf(const std::filesystem::path& folder);

// Makes what is missing, durably: the store's folder, those within it, the shards of blobs.
[[nodiscard]] Status MakeFolders(const std::filesystem::path& folder);

// While it is open, no other Store opens this folder: switching a new database to WAL does not wait for its turn.
[[nodiscard]] FileDescriptor LockOpening(const std::filesystem::path& folder);
// Marks the store as open until it is closed. Call it under LockOpening, before the database is opened: if the last
// process died with the store open, what it had moved into place is made durable, so that a blob that is in sight
// survives power loss, and half-written ones are removed.
// `has_log`: SQLite's log beside the database tells how it ended; else nothing does, and it is done in any case.
// kStorage where that log has lost commits (database/log_damage.h).
[[nodiscard]] Result<FileDescriptor> MarkOpen(const std::filesystem::path& folder, bool has_log);

}  // namespace rigcal::storage

// Stores as versions of before left them: what migrations are tested on.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "server/base/files/durable_file.h"
#include "storage/database/summing_files.h"

namespace rigcal::storage {

// The files of storage/schema, in the order in which they came.
inline std::vector<std::filesystem::path> SchemaFiles() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(RIGCAL_SOURCE_DIR "/storage/schema"))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.filename() < b.filename(); });
  return files;
}

// SQL that makes an empty store of that version for SQLite, marked as one of rigcal.
inline std::string EmptyStoreOfVersion(int version) {
  std::string sql;
  const std::vector<std::filesystem::path> files = SchemaFiles();
  for (std::size_t i = 0; i < static_cast<std::size_t>(version); ++i) sql += ReadFile(files.at(i), 1 << 20).value();
  return sql + "PRAGMA application_id = 1382499180; PRAGMA user_version = " + std::to_string(version) + ";";
}

// Of the version before this file came: "0018_causes.sql".
inline std::string EmptyStoreBefore(const std::string& file) {
  const std::vector<std::filesystem::path> files = SchemaFiles();
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const auto& path) { return path.filename() == file; });
  EXPECT_NE(found, files.end()) << file;
  return EmptyStoreOfVersion(static_cast<int>(found - files.begin()));
}

// A database as another program would leave it, or a rigcald of another version.
inline void MakeDatabase(const std::filesystem::path& folder, const std::string& sql) {
  SQLite::Database((folder / "rigcal.db").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, 0, SummingFiles())
      .exec(sql);
}

}  // namespace rigcal::storage

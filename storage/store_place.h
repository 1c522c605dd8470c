// Where a store keeps what: rows in a database, blobs and reports in a folder.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace rigcal::storage {

struct StorePlace {
  StorePlace() = default;
  // All in one folder. NOLINTNEXTLINE(google-explicit-constructor): a folder is a place
  StorePlace(std::filesystem::path data) : folder(std::move(data)) {}
  // NOLINTNEXTLINE(google-explicit-constructor): likewise
  StorePlace(const char* data) : folder(data) {}
  StorePlace(std::filesystem::path data, std::string rows) : folder(std::move(data)), server(std::move(rows)) {}

  std::filesystem::path folder;  // of blobs, intake and reports; of the rows too where `server` is empty
  std::string server;            // the database with the rows, as libpq takes it: "postgresql://..."; empty: SQLite
  std::string bucket;            // where blobs are durable: "s3://BUCKET/PREFIX" (s3/bucket.h); empty: in the folder
};

// Of `--store` and `--data`: "sqlite:FOLDER" or a folder alone; "postgresql://...", then with blobs and reports in
// `data`; empty: all in `data`. kInvalidInput for anything else.
[[nodiscard]] Result<StorePlace> StorePlaceOf(const std::string& store, const std::filesystem::path& data);

// For people, without a password: the folder, or "postgresql://host/database".
[[nodiscard]] std::string NameOf(const StorePlace& place);

}  // namespace rigcal::storage

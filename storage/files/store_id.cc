#include "storage/files/store_id.h"

#include "server/base/digests/secret.h"
#include "server/base/files/durable_file.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kIdBytesMax = 256;

std::string IdInStore(Connection& connection) {
  Query query(connection, "SELECT store_id FROM lease_folder");
  return query.Step() ? query.Text(0) : "";
}

std::string IdInFolder(const std::filesystem::path& file) {
  std::string id = ReadFile(file, kIdBytesMax).value_or("");
  while (!id.empty() && id.back() == '\n') id.pop_back();
  return id;
}

Status MakeId(Connection& connection, const std::filesystem::path& file) {
  const std::string id = NewSecret();
  RIGCAL_TRY(WriteDurably(file, id + "\n"));
  Query(connection, "INSERT INTO lease_folder VALUES (?)").Bind(id).Run();
  return {};
}

bool HasBucket(Connection& connection, const std::string& bucket) {
  return Query(connection, "SELECT 1 FROM lease_bucket WHERE place = ?").Bind(bucket).Step();
}

Error NotBegun(const StorePlace& place) {
  return {ErrorCode::kConflict,
          "the data folder " + place.folder.string() + " is new to the store at " + NameOf(place) +
              ", whose files are not in " + place.bucket + " yet",
          "Start the server that has the store's data folder with --blobs " + place.bucket + " first."};
}

Error NotItsFolder(const std::string& place, const std::filesystem::path& folder, bool is_of_another) {
  return {ErrorCode::kConflict,
          "the data folder " + folder.string() +
              (is_of_another ? " is that of another store than " : " is not that of ") + place,
          "Give with --data the folder that its other processes use. Where the files were moved or restored: the file "
          "store-id belongs "
          "to them, move it along."};
}

}  // namespace

Status TieFolder(Connection& connection, const StorePlace& place) {
  const std::filesystem::path file = place.folder / "store-id";
  const std::string in_folder = IdInFolder(file), subject = "the store at " + NameOf(place);
  bool is_known = false, is_made = false;
  RIGCAL_TRY(connection.Load(subject, [&]() -> Status {
    is_known = !in_folder.empty() && in_folder == IdInStore(connection);
    return {};
  }));
  if (is_known) return {};
  const Status tied = connection.Append(subject, [&]() -> Status {
    const std::string in_store = IdInStore(connection);  // another process may have made it just now
    if (!in_store.empty() && in_store == IdInFolder(file)) return {};
    if (!in_store.empty() && in_folder.empty() && !place.bucket.empty())
      return HasBucket(connection, place.bucket) ? WriteDurably(file, in_store + "\n") : Fail(NotBegun(place));
    if (!in_store.empty() || !in_folder.empty())
      return Fail(NotItsFolder(NameOf(place), place.folder, !in_folder.empty()));
    is_made = true;
    return MakeId(connection, file);
  });
  std::error_code ignored;
  if (!tied && is_made) std::filesystem::remove(file, ignored);  // the store has no id yet
  return tied;
}

}  // namespace rigcal::storage

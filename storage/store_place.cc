#include "storage/store_place.h"

namespace rigcal::storage {
namespace {

constexpr std::string_view kSqliteScheme = "sqlite:";

bool BeginsWith(const std::string& text, std::string_view begin) { return text.rfind(begin, 0) == 0; }

bool IsPostgres(const std::string& store) {
  return BeginsWith(store, "postgresql://") || BeginsWith(store, "postgres://");
}

}  // namespace

Result<StorePlace> StorePlaceOf(const std::string& store, const std::filesystem::path& data) {
  if (store.empty()) return StorePlace(data);
  if (IsPostgres(store)) return StorePlace(data, store);
  const bool is_named = BeginsWith(store, kSqliteScheme);
  const std::string folder = is_named ? store.substr(kSqliteScheme.size()) : store;
  if (folder.empty() || (!is_named && folder.find("://") != std::string::npos))
    return Fail(ErrorCode::kInvalidInput, "--store '" + store + "' is neither a folder nor a PostgreSQL database",
                "Write sqlite:FOLDER, or postgresql://USER@HOST/DATABASE.");
  return StorePlace(std::filesystem::path(folder));
}

std::string NameOf(const StorePlace& place) {
  if (place.server.empty()) return place.folder.string();
  // scheme://user:password@host/database?options: a password may hold a '?', and the options a password.
  const std::size_t host = place.server.find("://") + 3, first_at = place.server.find('@', host);
  const std::size_t options = place.server.find('?', first_at == std::string::npos ? host : first_at);
  const std::string shown = place.server.substr(0, options);
  const std::size_t at = shown.rfind('@');
  return at == std::string::npos ? shown : shown.substr(0, host) + shown.substr(at + 1);
}

}  // namespace rigcal::storage

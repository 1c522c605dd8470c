#include "client/import/files/session_folder.h"

#include <span>
#include <vector>

#include "client/bags/byte_source.h"
#include "client/bags/parts.h"
#include "client/import/files/bag_copy.h"
#include "client/import/files/held_folder.h"
#include "client/text/table.h"
#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::importing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecord = ".rigcal-import.json";  // session folders do not look at files that begin with a dot
constexpr const char* kOutcome = ".rigcal-import-outcome.json";
constexpr const char* kBag = ".rigcal-import-bag.json";
constexpr const char* kSession = "session.yaml";
constexpr std::size_t kRecordBytesMax = 16 << 20;

// Of its first and last 64 KiB: two bags may share a name and a size. Nothing of one that cannot be read.
std::string EndsOf(const fs::path& file) {
  constexpr std::uint64_t kEndBytes = 64 << 10;
  const auto source = bags::OpenSource(file);
  if (!source) return "";
  std::vector<std::byte> bytes(2 * kEndBytes);
  const std::uint64_t size = (*source)->size(), last = size > kEndBytes ? size - kEndBytes : 0;
  const auto front = (*source)->ReadAt(0, std::span(bytes).first(kEndBytes));
  const auto back = (*source)->ReadAt(last, std::span(bytes).last(kEndBytes));
  return front && back ? Sha256Of(std::span<const std::byte>(bytes)).str() : "";
}

// What a run left that was ended amid its first file, the record.
void RemoveUnfinishedRecord(const fs::path& folder) {
  std::vector<fs::path> unfinished;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().filename().string().starts_with(std::string(kRecord) + ".tmp-")) unfinished.push_back(at->path());
  for (const fs::path& file : unfinished) fs::remove(file, failed);
}

// What a run that was ended amid a file left beside it.
void RemoveUnfinished(const fs::path& folder) {
  std::vector<fs::path> unfinished;
  std::error_code failed;
  for (fs::recursive_directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().filename().string().find(".tmp-") != std::string::npos) unfinished.push_back(at->path());
  for (const fs::path& file : unfinished) fs::remove(file, failed);
}

}  // namespace

Result<SessionFolder> SessionFolder::Begin(const fs::path& folder, const std::string& identity) {
  if (const auto made = MakeFolder(folder); !made) return Fail(made.error());
  std::error_code failed;
  if (!fs::exists(folder / kRecord, failed)) {
    RemoveUnfinishedRecord(folder);
    if (!fs::is_empty(folder, failed) || failed)
      return Fail(ErrorCode::kConflict, folder.string() + " is not empty", "Give the path of a new folder.");
    RIGCAL_TRY(WriteDurably(folder / kRecord, identity));
    return SessionFolder(folder);
  }
  RIGCAL_ASSIGN(const std::string before, ReadFile(folder / kRecord, kRecordBytesMax));
  if (before == identity) {
    RemoveUnfinished(folder);
    return SessionFolder(folder);
  }
  return Fail(
      ErrorCode::kConflict,
      folder.string() + " holds the import of another bag, or of this one with another rig.yaml or other options",
      "Give the path of a new folder, or remove that one.");
}

Status SessionFolder::RemoveOther(const fs::path& folder, const std::string& identity) {
  std::error_code failed;
  if (!fs::exists(folder / kRecord, failed)) return {};
  RIGCAL_ASSIGN(const std::string before, ReadFile(folder / kRecord, kRecordBytesMax));
  return before == identity ? Status() : Remove(folder);
}

Status SessionFolder::Remove(const fs::path& folder) {
  std::error_code failed;
  std::vector<fs::path> others;  // the record last, and whose bag it is: what is left is still known for what it is
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().filename() != kRecord && at->path().filename() != kBag) others.push_back(at->path());
  others.insert(others.end(), {folder / kBag, folder / kRecord});
  for (auto other = others.begin(); !failed && other != others.end(); ++other) fs::remove_all(*other, failed);
  if (!failed) return {};
  return Fail(ErrorCode::kStorage, folder.string() + ": cannot be removed (" + failed.message() + ")",
              "It is left of another push; check its permissions.");
}

Status CheckRoomOf(const fs::path& folder, std::uint64_t needed_bytes, std::uint64_t free_bytes) {
  if (needed_bytes <= free_bytes) return {};
  const auto text = [](std::uint64_t bytes) { return client::ByteText(static_cast<double>(bytes)); };
  return Fail(
      ErrorCode::kBusy,
      folder.string() + " takes up to " + text(needed_bytes) + ", and its disk has " + text(free_bytes) + " free",
      "Free the rest and give the same command again, take fewer captures by --every, or give a folder on another "
      "disk.");
}

Status SessionFolder::CheckRoom(std::uint64_t needed_bytes) const {
  std::error_code failed;
  const fs::space_info disk = fs::space(folder_, failed);
  return failed ? Status() : CheckRoomOf(folder_, needed_bytes, disk.available);  // where none is told, writing will
}

Result<bool> SessionFolder::TakeBag(const fs::path& bag,
                                    const std::function<void(std::int64_t, std::int64_t)>& progress) const {
  RIGCAL_ASSIGN(BagCopy now, MarksOf(bag));
  if (!Has(kBag)) {
    if (complete()) return true;
    RIGCAL_ASSIGN(now.sha256, DigestOf(bag, progress));
    RIGCAL_TRY(WriteDurably(folder_ / kBag, BagCopyJson(now)));
    return true;
  }
  RIGCAL_ASSIGN(const std::string text, ReadFile(folder_ / kBag, kRecordBytesMax));
  RIGCAL_ASSIGN(const BagCopy before, ReadBagCopy(text));
  RIGCAL_ASSIGN(const bool same, HasBytesOf(before, bag, now, progress));
  if (same && now.marks != before.marks)  // a disk that takes no more only has the bag read again next time
    static_cast<void>(WriteDurably(folder_ / kBag, BagCopyJson(now)));
  return same;
}

bool SessionFolder::complete() const { return Has(kSession); }

bool SessionFolder::Has(const std::string& file) const {
  std::error_code failed;
  return fs::exists(folder_ / file, failed);
}

Status SessionFolder::Write(const std::string& file, std::string_view bytes) const {
  if (const auto made = MakeFolder((folder_ / file).parent_path()); !made) return Fail(made.error());
  return WriteDurably(folder_ / file, bytes);
}

Result<std::string> SessionFolder::LoadOutcome() const {
  return Has(kOutcome) ? ReadFile(folder_ / kOutcome, kRecordBytesMax) : std::string();
}

Status SessionFolder::Finish(std::string_view session_yaml, std::string_view outcome) const {
  RIGCAL_TRY(WriteDurably(folder_ / kOutcome, outcome));
  return WriteDurably(folder_ / kSession, session_yaml);
}

Result<std::string> IdentityOf(const fs::path& bag, std::string_view rig_yaml, std::int64_t tolerance_ns,
                               std::int64_t every_ns) {
  RIGCAL_ASSIGN(const bags::Parts parts, bags::PartsOf(bag));
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Integer("format", 1);
    out.Text("rig_sha256", Sha256Of(rig_yaml).str());
    out.Integer("tolerance_ns", tolerance_ns);
    out.Integer("every_ns", every_ns);
    out.List("bag", [&] {
      for (const fs::path& file : parts.files) {
        std::error_code missing;
        const auto size = fs::file_size(file, missing);
        out.Object([&] {
          out.Text("file", file.filename().string());
          out.Integer("size_bytes", missing ? -1 : static_cast<std::int64_t>(size));
          out.Text("ends_sha256", EndsOf(file));
        });
      }
    });
  });
}

}  // namespace rigcal::importing

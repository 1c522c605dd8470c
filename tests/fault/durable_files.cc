// durable_files ACT FOLDER: does what promises to be durable, and marks it in the disk's record as a server would by a
// receipt: the parts of storage and base whose syncs other syncs of a whole server cover by chance. Acts below.
#include <SQLiteCpp/SQLiteCpp.h>
#include <dlfcn.h>

#include <cstdio>
#include <filesystem>
#include <span>
#include <string>

#include "client/bags/mcap/mcap_writer.h"
#include "client/import/files/held_folder.h"
#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"
#include "storage/audit.h"
#include "storage/files/blobs.h"
#include "storage/files/folders.h"
#include "storage/store.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;

void Mark(const std::string& text) {
  static const auto mark = reinterpret_cast<void (*)(const char*)>(dlsym(RTLD_DEFAULT, "RigcalFaultMark"));
  if (mark != nullptr) mark(text.c_str());
}

void MarkKept(const fs::path& file, const fs::path& root) { Mark("kept " + fs::relative(file, root).string()); }

// A file, and another in its place: until that is durable it may be either.
Status WriteTwice(const fs::path& folder) {
  RIGCAL_TRY(WriteDurably(folder / "file", "first"));
  MarkKept(folder / "file", folder.parent_path());
  Mark("or " + fs::relative(folder / "file", folder.parent_path()).string() + " second");
  RIGCAL_TRY(WriteDurably(folder / "file", "second"));
  MarkKept(folder / "file", folder.parent_path());
  return {};
}

// Again where it failed: that it is in sight does not say that it is durable.
Status KeepBlob(const fs::path& folder, std::string_view content) {
  Result<Digest> digest = storage::AppendBlob(storage::BlobFolderOf(folder), content);
  if (!digest) digest = storage::AppendBlob(storage::BlobFolderOf(folder), content);
  if (!digest) return Fail(digest.error());
  MarkKept(storage::BlobPath(storage::BlobFolderOf(folder), *digest), folder.parent_path());
  return {};
}

// Without a database, as where it is a PostgreSQL's.
Status MakeNew(const fs::path& folder) {
  RIGCAL_TRY(storage::MakeFolders(folder));
  return KeepBlob(folder, "of a new folder");
}

// A tool that copies folders may leave out those that are empty.
Status MakeShardAgain(const fs::path& folder) {
  const std::string content = "of a shard that went";
  fs::remove(storage::BlobPath(storage::BlobFolderOf(folder), Sha256Of(content)).parent_path());
  return KeepBlob(folder, content);
}

Status AddRow(const fs::path& folder) {
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(folder));
  return storage::AppendAudit(store, {1}, "Ada", "looked");
}

// What is in sight is told, whoever wrote it.
Status TellRows(const fs::path& folder) {
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(folder));
  Mark("rows audit " + store.database().execAndGet("SELECT count(*) FROM audit").getString());
  return {};
}

Status WriteBag(const fs::path& folder) {
  RIGCAL_ASSIGN(bags::McapWriter writer, bags::McapWriter::Create(folder / "drive.mcap"));
  RIGCAL_ASSIGN(const std::uint16_t channel,
                writer.Add({"/left/info", "std_msgs/msg/String", "cdr", "ros2msg", "string data"}));
  RIGCAL_TRY(writer.Write(channel, 1, 1, std::as_bytes(std::span("message"))));
  RIGCAL_TRY(writer.Close());
  MarkKept(folder / "drive.mcap", folder.parent_path());
  return {};
}

// Two folders that were not there.
Status WriteInNewFolder(const fs::path& folder) {
  const fs::path below = folder / "drives" / "monday";
  if (const auto made = importing::MakeFolder(below); !made) return Fail(made.error());
  RIGCAL_TRY(WriteDurably(below / "session.yaml", "format: 1"));
  MarkKept(below / "session.yaml", folder.parent_path());
  return {};
}

Status Run(const std::string& act, const fs::path& folder) {
  if (act == "write-twice") return WriteTwice(folder);
  if (act == "make-new") return MakeNew(folder);
  if (act == "keep-blob") return KeepBlob(folder, "once more");
  if (act == "make-shard-again") return MakeShardAgain(folder);
  if (act == "add-row") return AddRow(folder);
  if (act == "write-bag") return WriteBag(folder);
  if (act == "write-in-new-folder") return WriteInNewFolder(folder);
  if (act == "tell-rows") return TellRows(folder);
  return Fail(ErrorCode::kInvalidInput, "there is no act " + act, "See durable_files.cc.");
}

}  // namespace
}  // namespace rigcal

int main(int count, char** words) {
  if (count != 3) return 2;
  const rigcal::Status done = rigcal::Run(words[1], words[2]);
  if (!done) std::fprintf(stderr, "%s\n", rigcal::Sentence(done.error()).c_str());
  return done ? 0 : 4;
}

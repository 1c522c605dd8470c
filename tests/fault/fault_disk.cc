#include "tests/fault/fault_disk.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>

namespace rigcal::fault {
namespace {

FaultDisk* g_disk = nullptr;

// SQLite allocates szOsFile bytes: ours, then those of the real file.
struct FaultFile {
  sqlite3_file base;
  std::string* path;  // null: a temporary file without a name
  [[nodiscard]] sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

FaultFile* Ours(sqlite3_file* file) { return reinterpret_cast<FaultFile*>(file); }
sqlite3_file* Real(sqlite3_file* file) { return Ours(file)->real(); }
const sqlite3_io_methods* Methods(sqlite3_file* file) { return Real(file)->pMethods; }

std::string ContentOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int Close(sqlite3_file* file) {
  delete Ours(file)->path;
  return Methods(file)->xClose(Real(file));
}

int Read(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  return Methods(file)->xRead(Real(file), bytes, count, offset);
}

int Write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
  if (!g_disk->FailsNow()) return Methods(file)->xWrite(Real(file), bytes, count, offset);
  if (count > 1) Methods(file)->xWrite(Real(file), bytes, count / 2, offset);
  return SQLITE_FULL;
}

int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  return g_disk->FailsNow() ? SQLITE_IOERR_TRUNCATE : Methods(file)->xTruncate(Real(file), size);
}

// The real disk need not be waited for: what a sync secures is kept by FaultDisk.
int Sync(sqlite3_file* file, int) {
  if (g_disk->FailsNow()) return SQLITE_IOERR_FSYNC;
  if (Ours(file)->path != nullptr) g_disk->OnSync(*Ours(file)->path);
  return SQLITE_OK;
}

int FileSize(sqlite3_file* file, sqlite3_int64* size) { return Methods(file)->xFileSize(Real(file), size); }
int Lock(sqlite3_file* file, int level) { return Methods(file)->xLock(Real(file), level); }
int Unlock(sqlite3_file* file, int level) { return Methods(file)->xUnlock(Real(file), level); }
int CheckLock(sqlite3_file* file, int* out) { return Methods(file)->xCheckReservedLock(Real(file), out); }
int Control(sqlite3_file* file, int op, void* arg) { return Methods(file)->xFileControl(Real(file), op, arg); }
int SectorSize(sqlite3_file* file) { return Methods(file)->xSectorSize(Real(file)); }
int Traits(sqlite3_file* file) { return Methods(file)->xDeviceCharacteristics(Real(file)); }
int ShmMap(sqlite3_file* file, int page, int size, int extend, void volatile** out) {
  return Methods(file)->xShmMap(Real(file), page, size, extend, out);
}
int ShmLock(sqlite3_file* file, int offset, int n, int flags) {
  return Methods(file)->xShmLock(Real(file), offset, n, flags);
}
void ShmBarrier(sqlite3_file* file) { Methods(file)->xShmBarrier(Real(file)); }
int ShmUnmap(sqlite3_file* file, int remove) { return Methods(file)->xShmUnmap(Real(file), remove); }

// Version 2: with shared memory (WAL), without memory-mapped reading.
constexpr sqlite3_io_methods kMethods = {2,       Close,      Read,      Write,   Truncate,   Sync,   FileSize,
                                         Lock,    Unlock,     CheckLock, Control, SectorSize, Traits, ShmMap,
                                         ShmLock, ShmBarrier, ShmUnmap,  nullptr, nullptr};

int Open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  FaultFile* ours = Ours(file);
  ours->base.pMethods = nullptr;
  ours->path = nullptr;
  const int result = g_disk->real()->xOpen(g_disk->real(), name, ours->real(), flags, out_flags);
  if (result != SQLITE_OK) return result;
  ours->base.pMethods = &kMethods;
  if (name != nullptr) ours->path = new std::string(name);
  if (name != nullptr) g_disk->OnOpen(name);
  return SQLITE_OK;
}

int Delete(sqlite3_vfs*, const char* name, int sync_folder) {
  if (g_disk->FailsNow()) return SQLITE_IOERR_DELETE;
  const int result = g_disk->real()->xDelete(g_disk->real(), name, sync_folder);
  if (result == SQLITE_OK) g_disk->OnDelete(name);
  return result;
}

}  // namespace

FaultDisk::FaultDisk() : real_(sqlite3_vfs_find(nullptr)) {
  wrapper_ = *real_;  // what is not replaced works on names, not on files
  wrapper_.zName = "fault";
  wrapper_.szOsFile = static_cast<int>(sizeof(FaultFile)) + real_->szOsFile;
  wrapper_.xOpen = Open;
  wrapper_.xDelete = Delete;
  g_disk = this;
  sqlite3_vfs_register(&wrapper_, 1);
}

FaultDisk::~FaultDisk() {
  sqlite3_vfs_unregister(&wrapper_);
  sqlite3_vfs_register(real_, 1);
  g_disk = nullptr;
}

void FaultDisk::Arm(Fault fault, int at) {
  fault_ = fault;
  at_ = at;
  count_ = 0;
  failed_ = false;
}

void FaultDisk::Repair() {
  at_ = 0;
  if (fault_ != Fault::kPowerLoss || !failed_) return;
  for (const auto& [path, content] : synced_) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
    std::filesystem::remove(path + "-shm");
  }
}

bool FaultDisk::FailsNow() {
  if (at_ == 0) return false;
  ++count_;
  const bool fails = count_ == at_ || (count_ > at_ && fault_ != Fault::kOnce);
  failed_ = failed_ || fails;
  return fails;
}

// What a file holds before it is first opened is on disk.
void FaultDisk::OnOpen(const std::string& path) {
  if (synced_.count(path) == 0) synced_[path] = ContentOf(path);
}
void FaultDisk::OnSync(const std::string& path) { synced_[path] = ContentOf(path); }
void FaultDisk::OnDelete(const std::string& path) { synced_.erase(path); }

}  // namespace rigcal::fault

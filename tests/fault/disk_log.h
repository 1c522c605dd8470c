// What a program did to the files below one folder, in the order in which it did it: the record from which
// tests/fault/crashed_disk.py makes the disk as a power loss would leave it. Inside a preloaded library: nothing here
// may call what the library replaces, but by `real`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rigcal::fault {

// One byte of the log; crashed_disk.py knows the same.
enum class DiskAct : std::uint8_t {
  kCreate = 1,    // path, inode; an empty path: a file without a name
  kWrite = 2,     // inode, offset, bytes
  kTruncate = 3,  // inode, offset: the size from now on; longer than before: zeros
  kRename = 4,    // path, other
  kLink = 5,      // inode, path
  kRemove = 6,    // path: of a file or of an empty folder
  kMakeFolder = 7,
  kSync = 8,      // inode, path; offset 1: a folder; other: the program; bytes: return addresses of who asked for it
  kSyncDisk = 9,  // likewise; everything
  kMark = 10,     // path: what was told to somebody outside; whatever it promises must survive from here on
};

struct DiskRecord {
  DiskAct act;
  std::uint64_t inode = 0;
  std::int64_t offset = 0;
  std::string_view path, other, bytes;
};

// Both are set by the environment: RIGCAL_FAULT_ROOT and RIGCAL_FAULT_LOG. Without either nothing is recorded.
[[nodiscard]] bool IsRecording();

// What happens and its record are one step, also among processes that write the same log.
class DiskTurn {
 public:
  DiskTurn();
  ~DiskTurn();
  DiskTurn(const DiskTurn&) = delete;
  DiskTurn& operator=(const DiskTurn&) = delete;
  void Note(const DiskRecord& record);

 private:
  int log_;
};

// Absolute, without `.` and `..`; links are not followed.
[[nodiscard]] std::string AbsolutePath(int folder, const char* path);
// Empty: none, or nothing that has a name in a file system.
[[nodiscard]] std::string PathOf(int descriptor);
// Below the root; the shared memory of SQLite (`-shm`) is no data and does not count.
[[nodiscard]] bool IsOurs(std::string_view path);
[[nodiscard]] bool IsRootOrOurs(std::string_view path);
// Of the file that runs.
[[nodiscard]] const std::string& ProgramName();
// Return addresses within the program itself, relative to where it was loaded; 8 bytes each, the innermost first.
[[nodiscard]] std::string Callers();

}  // namespace rigcal::fault

// The session folder that an import writes: whole files only, and nothing of another import.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal::importing {

// One process at a time works on a folder: who begins holds it (held_folder.h).
class SessionFolder {
 public:
  // Makes the folder, or goes on with one that the same import (`identity`, a text of its input) began. kConflict: it
  // holds something else.
  [[nodiscard]] static Result<SessionFolder> Begin(const std::filesystem::path& folder, const std::string& identity);
  // Empties the folder if it holds what another import than `identity` began; nothing else is touched.
  [[nodiscard]] static Status RemoveOther(const std::filesystem::path& folder, const std::string& identity);
  // Empties it.
  [[nodiscard]] static Status Remove(const std::filesystem::path& folder);
  // kBusy: its disk has fewer bytes free than that.
  [[nodiscard]] Status CheckRoom(std::uint64_t needed_bytes) const;
  // False: what is here came of a copy of the bag with other bytes, and stays for that one's. Of a folder that is begun
  // the bag is read, and which bytes they are is kept. True where an older version kept nothing of it.
  [[nodiscard]] Result<bool> TakeBag(const std::filesystem::path& bag,
                                     const std::function<void(std::int64_t, std::int64_t)>& progress) const;
  // Whether the import came to its end before.
  [[nodiscard]] bool complete() const;
  // Of "left/1586406456-763032325.png": written already.
  [[nodiscard]] bool Has(const std::string& file) const;
  // The whole file or none; durable when it returns. Any thread.
  [[nodiscard]] Status Write(const std::string& file, std::string_view bytes) const;
  // session.yaml, which is the end of it; before it `outcome`, a text of what became of the bag, for who goes on here.
  [[nodiscard]] Status Finish(std::string_view session_yaml, std::string_view outcome) const;
  // That text of an import that came to its end; empty: it kept none.
  [[nodiscard]] Result<std::string> LoadOutcome() const;

 private:
  explicit SessionFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

// The sentence for files of `needed_bytes` where `free_bytes` are free.
[[nodiscard]] Status CheckRoomOf(const std::filesystem::path& folder, std::uint64_t needed_bytes,
                                 std::uint64_t free_bytes);

// What makes two imports the same: the names, sizes and ends of the bag's files, the rig's text, the options.
[[nodiscard]] Result<std::string> IdentityOf(const std::filesystem::path& bag, std::string_view rig_yaml,
                                             std::int64_t tolerance_ns, std::int64_t every_ns);

}  // namespace rigcal::importing

#include "tests/unit/move/fixture.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace rigcal::storage {

void MoveTest::KillAfter(int steps, MoveOptions words) {
  const pid_t child = fork();
  if (child == 0) {
    words.progress = [left = steps](MoveStage, std::int64_t, std::int64_t) mutable {
      if (--left == 0) raise(SIGKILL);
    };
    _exit(MoveStore(words) ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
}

std::map<std::string, std::int64_t> CountsOf(Store& store) {
  std::map<std::string, std::int64_t> counts;
  const auto tables = LoadSchemaTables().value();
  for (const SchemaTable& table : tables) counts[table.name] = IntIn(store, "SELECT count(*) FROM " + table.name);
  return counts;
}

}  // namespace rigcal::storage

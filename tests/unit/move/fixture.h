// A store in a data folder, and where it is to be: on PostgreSQL where these tests run on that, else in another folder.
#pragma once

#include <gmock/gmock.h>

#include <map>
#include <string>

#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/move/move_store.h"
#include "storage/move/schema_tables.h"
#include "tests/unit/storage/full_store.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {

class MoveTest : public UpkeepTest {
 protected:
  [[nodiscard]] StorePlace from() const { return data(); }
  [[nodiscard]] StorePlace to() const { return database_.In(folder_.path() / "copy"); }
  [[nodiscard]] MoveOptions options() const {
    MoveOptions words;
    words.from = from(), words.to = to();
    return words;
  }
  [[nodiscard]] Result<Moved> Move() const { return MoveStore(options()); }
  // What it says.
  [[nodiscard]] std::string Refusal() const { return WordsOf(Move()); }

  // A row in each table, and files, with names of the length that a fleet has.
  void FillStore() {
    Store store = Open();
    FillEveryTable(store);
    for (const char* name : {"mapper-02", "Mapper-03", "mapper_10"}) {
      const RobotId robot{name};
      Push(store, 7, robot);
    }
    EXPECT_TRUE(AppendBlob(store.BlobFolder(), "image"));
  }
  // kill -9 of a process that is at `words`, when it tells of its progress for the `steps`th time.
  static void KillAfter(int steps, MoveOptions words);

  TempDatabase database_;
};

// Of every table that is moved: how many rows it has.
std::map<std::string, std::int64_t> CountsOf(Store& store);

}  // namespace rigcal::storage

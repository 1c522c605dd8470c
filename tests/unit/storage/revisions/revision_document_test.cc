// Documents of revisions are kept compressed; those of before stay as they are; what is damaged is said in one
// sentence.

#include "storage/database/compressed.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kMax = 1 << 20;

// Of many rows that are much alike, as documents are.
std::string SomeDocument(int rows) {
  std::string text = "{\"edges\":[";
  for (int i = 0; i < rows; ++i)
    text += (i == 0 ? "" : ",") + std::string("{\"frame_a\":\"left\",\"id\":\"") + DigestOf(std::to_string(i)).str() +
            "\",\"method\":\"stereo\"}";
  return text + "]}";
}

TEST(Compressed, ComesBackAndIsAlwaysTheSame) {
  for (const std::string& text : {std::string(), std::string("x"), SomeDocument(1000), std::string(kMax, 'd')}) {
    const auto bytes = Compress("it", text, kMax);
    ASSERT_TRUE(bytes) << WordsOf(bytes);
    EXPECT_EQ(*bytes, Compress("it", text, kMax).value());
    EXPECT_EQ(Decompress("it", *bytes, kMax).value(), text);
  }
  EXPECT_LT(Compress("it", SomeDocument(1000), kMax)->size(), SomeDocument(1000).size() / 2);
}

TEST(Compressed, NoByteIsTakenForAnother) {
  const std::string text = SomeDocument(3), bytes = Compress("it", text, kMax).value();
  std::size_t refused = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x01);
    const auto read = Decompress("it", damaged, kMax);
    if (read) {
      EXPECT_EQ(*read, text) << i;  // a bit that fills a byte up
      continue;
    }
    ++refused;
    EXPECT_EQ(read.error().code, ErrorCode::kStorage) << i;
    EXPECT_EQ(read.error().what.rfind("it is damaged: ", 0), 0U) << read.error().what;
  }
  EXPECT_GT(refused, bytes.size() / 2);
  for (const std::string& wrong : {bytes.substr(0, bytes.size() - 1), bytes.substr(0, 3), bytes + "x", bytes + bytes,
                                   std::string("{}"), std::string()})
    EXPECT_FALSE(Decompress("it", wrong, kMax)) << wrong.size();
}

// A frame that says its size in eight bytes.
std::string ClaimOf(std::uint64_t bytes) {
  std::string frame("\x28\xb5\x2f\xfd\xe0", 5);
  for (int i = 0; i < 8; ++i) frame.push_back(static_cast<char>(bytes >> (8 * i) & 0xff));
  return frame + std::string("\x0b\x00\x00x", 4);  // its last block: one byte, repeated
}

TEST(Compressed, ASizeThatCannotBeIsNotBelieved) {
  EXPECT_EQ(Decompress("it", ClaimOf(1), kMax).value(), "x");
  EXPECT_EQ(Decompress("it", ClaimOf(kMax + 1), kMax).error().what, "it is damaged: 17 bytes claim to hold 1048577");
  const std::uint64_t absurd = std::uint64_t{1} << 29;  // within the limit, and far more than such bytes can hold
  EXPECT_EQ(Decompress("it", ClaimOf(absurd), std::size_t{1} << 30).error().what,
            "it is damaged: 17 bytes claim to hold 536870912");
  EXPECT_FALSE(Decompress("it", ClaimOf(~std::uint64_t{2}), kMax));
  EXPECT_EQ(Compress("it", "four", 3).error().what, "it has 4 bytes; the limit is 3");
}

class RevisionDocumentStoreTest : public StoreTest {
 protected:
  void Append(const std::string& document) {
    Revision revision = MakeRevision(1);
    revision.document = document;
    revision.digest = DigestOf(document);
    const auto number = AppendRevision(store_, revision);
    ASSERT_TRUE(number) << WordsOf(number);
  }
  Error ErrorOfNewest() {
    const auto revision = LoadRevision(store_, kRobot, 0);
    return revision ? Error{} : revision.error();
  }
};

TEST_F(RevisionDocumentStoreTest, IsKeptCompressedAlone) {
  const std::string document = SomeDocument(2000);
  Append(document);
  EXPECT_EQ(TextIn(store_, "SELECT document FROM revision"), "");
  EXPECT_LT(IntIn(store_, "SELECT length(zstd) FROM revision_document"),
            static_cast<std::int64_t>(document.size() / 2));
  const Revision revision = LoadRevision(store_, kRobot, 1).value().value();
  EXPECT_EQ(revision.document, document);
  EXPECT_EQ(revision.digest, DigestOf(document));
}

TEST_F(RevisionDocumentStoreTest, ThatIsDamagedIsSaidInOneSentence) {
  Append(SomeDocument(10));
  TamperWith(place(), "UPDATE revision_document SET zstd = substr(zstd, 1, length(zstd) - 9)");
  EXPECT_EQ(ErrorOfNewest().code, ErrorCode::kStorage);
  EXPECT_EQ(ErrorOfNewest().what.rfind("the document of revision 1 of robot mapper-01 is damaged: ", 0), 0U)
      << ErrorOfNewest().what;
  EXPECT_TRUE(LoadRevisionSummary(store_, kRobot, 1).value().has_value());
  TamperWith(place(), "UPDATE revision_document SET zstd = " + BytesInSql("28b52ffde00000000000000100010000"));
  EXPECT_EQ(Sentence(ErrorOfNewest()),
            "the document of revision 1 of robot mapper-01 is damaged: 16 bytes claim to hold 281474976710656. Restore "
            "the database from "
            "a backup.");
  TamperWith(place(), "DELETE FROM revision_document");
  EXPECT_EQ(ErrorOfNewest().what, "the document of revision 1 of robot mapper-01 is missing");
}

// Version 15, in which documents stood in the table of revisions.
std::string StoreOfVersion15(const std::string& document) {
  return EmptyStoreOfVersion(15) +
         "INSERT INTO robot VALUES ('mapper-01', 1);"
         "INSERT INTO revision VALUES ('mapper-01', 1, 9, 2, 'pass', 'why', '', '" +
         DigestOf(document).str() + "', '" + document + "');";
}

TEST(RevisionDocumentMigration, OlderRevisionsStayReadable) {
  const TempFolder folder;
  const std::string before = SomeDocument(5), after = SomeDocument(6);
  MakeDatabase(folder.path(), StoreOfVersion15(before));
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  Revision revision = MakeRevision(3);
  revision.document = after;
  revision.digest = DigestOf(after);
  EXPECT_EQ(AppendRevision(*store, revision).value(), 2);
  EXPECT_EQ(LoadRevision(*store, kRobot, 1).value()->document, before);
  EXPECT_EQ(LoadRevision(*store, kRobot, 1).value()->digest, DigestOf(before));
  EXPECT_EQ(LoadRevision(*store, kRobot, 2).value()->document, after);
  EXPECT_EQ(store->database().execAndGet("SELECT count(*) FROM revision_document").getInt(), 1);
}

}  // namespace
}  // namespace rigcal::storage

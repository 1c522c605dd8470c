// What was backed up comes back as it was, into a folder that is nobody's.
#include "storage/access/access_tokens.h"
#include "storage/access/accounts.h"
#include "storage/access/login_sessions.h"
#include "storage/files/folder_lock.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;

class RestoreBackupTest : public UpkeepTest {
 protected:
  Result<Restored> Restore(int number = 0) { return RestoreBackup({backup(), restored(), number}); }
};

TEST_F(RestoreBackupTest, GivesBackEveryRowAndFile) {
  Store store = Open();
  const EdgeId edge = Calibrate(store, Push(store, 5));
  ASSERT_TRUE(Back());
  const auto done = Restore();
  ASSERT_TRUE(done) << WordsOf(done);
  EXPECT_EQ(done->blobs, 6);  // with the picture
  EXPECT_TRUE(done->lost.empty());
  EXPECT_EQ(Fsck({restored()}, clock_)->unmended(), 0);
  Store again = Store::Open(restored()).value();
  EXPECT_TRUE(LoadEdge(again, edge).value());
  EXPECT_EQ(LoadBlob(again.BlobFolder(), DigestOf(ContentOf(4)), 100).value(), ContentOf(4));
}

TEST_F(RestoreBackupTest, SumsOfPagesAreThoseOfTheDatabaseThatWasHeldAgainstItsDigest) {
  Store store = Open();
  Push(store, 5);
  ASSERT_TRUE(Back());
  FlipByte(backup() / "000001" / "rigcal.db-sums", 17);
  ASSERT_TRUE(Restore());
  const auto done = Fsck({restored()}, clock_);
  EXPECT_EQ(done->unmended(), 0);
  EXPECT_EQ(done->pages_unknown, 0);
}

TEST_F(RestoreBackupTest, LetsNobodyInWhoWasLoggedInAndNamesWhoMayLogIn) {
  Store store = Open();
  const Word word{clock_.Now(), "root", ""};
  const Account ada = AddAccount(store, {0, "ada", Role::kAdmin, "a hash", word}).value();
  ASSERT_TRUE(AddAccount(store, {0, "bob", Role::kViewer, "a hash", word}));
  ASSERT_TRUE(BeginLogin(store, DigestOf("a secret"), ada, clock_.Now()));
  ASSERT_TRUE(AddAccessToken(store, {0, "grafana", Role::kViewer, DigestOf("a token"), word}));
  ASSERT_TRUE(AddAccessToken(store, {0, "old", Role::kViewer, DigestOf("another"), word}));
  ASSERT_TRUE(RevokeAccessToken(store, "old", word));
  ASSERT_TRUE(Back());
  const auto done = Restore();
  ASSERT_TRUE(done) << WordsOf(done);
  EXPECT_THAT(done->users, testing::ElementsAre("ada", "bob"));
  EXPECT_THAT(done->tokens, testing::ElementsAre("grafana"));
  EXPECT_EQ(Fsck({restored()}, clock_)->unmended(), 0);
  Store again = Store::Open(restored()).value();
  EXPECT_FALSE(SeeLogin(again, DigestOf("a secret"), clock_.Now()).value());
  EXPECT_TRUE(LoadAccount(again, "ada").value());
}

TEST_F(RestoreBackupTest, IntoAnEmptyFolderOnly) {
  Store store = Open();
  ASSERT_TRUE(Back());
  fs::create_directory(restored());
  std::ofstream(restored() / "letters") << "dear";
  EXPECT_THAT(Restore().error().what, HasSubstr("is not empty"));
  fs::remove(restored() / "letters");
  EXPECT_TRUE(Restore());
  ASSERT_TRUE(LockFolder(data()));
  EXPECT_THAT(RestoreBackup({backup(), data()}).error().what, HasSubstr("a rigcald uses the data folder"));
}

TEST_F(RestoreBackupTest, NamesWhatTheBackupHasDamaged) {
  Store store = Open();
  Push(store, 5);
  ASSERT_TRUE(Back());
  FlipByte(KeptBlobOf(ContentOf(3)), 0);
  const auto done = Restore();
  ASSERT_TRUE(done) << WordsOf(done);
  ASSERT_EQ(done->lost.size(), 1U);
  EXPECT_THAT(done->lost.front(), HasSubstr("left/100003.png of session "));
  EXPECT_FALSE(fs::exists(BlobPath(restored() / "blobs", DigestOf(ContentOf(3)))));
}

TEST_F(RestoreBackupTest, RefusesADamagedDatabaseAndTakesTheOneBefore) {
  Store store = Open();
  Push(store, 5);
  ASSERT_TRUE(Back());
  ASSERT_TRUE(Back());
  FlipByte(BackupOf(backup(), 2) / "rigcal.db", 5000);
  const auto refused = Restore();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().cure, HasSubstr("--number"));
  EXPECT_FALSE(fs::exists(restored()));
  EXPECT_EQ(Restore(7).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(Restore(1));
}

TEST_F(RestoreBackupTest, NoBackupIsSaidToBeNone) {
  EXPECT_EQ(Restore().error().code, ErrorCode::kNotFound);
  fs::create_directory(backup());
  EXPECT_EQ(Restore().error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(fs::exists(restored()));
}

}  // namespace
}  // namespace rigcal::storage

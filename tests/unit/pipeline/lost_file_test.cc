// A stored file that the disk has not kept: named in the edge, asked for again, the pair run again.
#include <gmock/gmock.h>

#include "server/model/edges/past.h"
#include "server/pipeline/answers/answer.h"
#include "storage/database/query.h"
#include "storage/files/lost_blobs.h"
#include "storage/revisions/revisions.h"
#include "storage/work/attempts.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class LostFileTest : public PipelineTest {
 protected:
  fs::path BlobOf(const std::string& bytes) const {
    return storage::BlobPath(store_->BlobFolder(), Sha256Of(std::string_view(bytes)));
  }
  static void FlipAByte(const fs::path& path) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(1000);
    const char old = static_cast<char>(file.get());
    file.seekp(1000);
    file.put(static_cast<char>(old ^ 1));
  }
  // As the recorder does when the bytes come again.
  void SendAgain(const SessionId& session, const std::string& bytes) {
    const Digest digest = storage::AppendBlob(store_->BlobFolder(), bytes).value();
    const auto manifest = storage::LoadManifest(*store_, session).value();
    for (std::uint32_t i = 0; i < manifest->payloads.size(); ++i) {
      if (manifest->payloads[i].digest != digest) continue;
      ASSERT_FALSE(storage::LoadHeld(*store_, session).value()[i]);
      ASSERT_TRUE(storage::AppendHeld(*store_, session, {i}, clock_.now));
    }
  }
  std::vector<Edge> Edges() { return storage::LoadEdges(*store_, RobotId("r"), false).value(); }
};

// The whole way, and the end is that of an undamaged session.
TEST_F(LostFileTest, AFlippedByteFailsTheEdgeByNameAndIsMendedByPushingAgain) {
  auto files = RealPictures();
  if (files.empty()) GTEST_SKIP() << "no stereo_opencv in ../shared/data";
  const std::string damaged = files.at("left/03.jpg"), missing = files.at("right/07.jpg");
  const SessionId session = StoreSession("r", files);
  FlipAByte(BlobOf(damaged));
  fs::remove(BlobOf(missing));
  StepAll();

  ASSERT_EQ(Edges().size(), 1u);
  const Edge failed = Edges().front();
  EXPECT_EQ(failed.state, EdgeState::kFailed);
  ASSERT_EQ(failed.diagnoses.size(), 1u);
  EXPECT_EQ(failed.diagnoses[0].code, kFileLostCode);
  EXPECT_THAT(failed.diagnoses[0].what,
              HasSubstr("robot r pushed of left, right: left/03.jpg (damaged), right/07.jpg (missing)"));
  EXPECT_THAT(failed.diagnoses[0].cure, HasSubstr("Push the session again"));
  EXPECT_FALSE(fs::exists(BlobOf(damaged)));
  EXPECT_TRUE(fs::exists(BlobOf(damaged).string() + ".damaged"));
  EXPECT_EQ(storage::LoadSession(*store_, session).value()->payloads_held, 24);
  ASSERT_EQ(revisions_.size(), 1u);

  SendAgain(session, damaged);
  EXPECT_EQ(storage::CountJobs(*store_, RobotId("r")).value(), 0);  // the other one is still missing
  SendAgain(session, missing);
  EXPECT_EQ(storage::CountJobs(*store_, RobotId("r")).value(), 1);
  StepAll();
  ASSERT_EQ(revisions_.size(), 2u);
  const auto document = formats::ReadRevisionDocument(revisions_.back().document);
  ASSERT_TRUE(document);
  ASSERT_EQ(document->edges.size(), 2u);
  EXPECT_EQ(std::count_if(document->edges.begin(), document->edges.end(), IsPast), 1);
  const auto good = std::find_if(document->edges.begin(), document->edges.end(),
                                 [](const Edge& edge) { return edge.state == EdgeState::kGood; });
  ASSERT_NE(good, document->edges.end());
  EXPECT_EQ(good->id, RepeatedEdgeId(failed.id));
  const Edge again = storage::LoadEdge(*store_, good->id).value().value();

  TearDown();
  SetUp();  // the same session, undisturbed
  StoreSession("r", files);
  StepAll();
  ASSERT_EQ(Edges().size(), 1u);
  EXPECT_EQ(Edges().front().T_a_b, again.T_a_b);
  EXPECT_EQ(Edges().front().figures, again.figures);
}

// Nothing is concluded of a file that nobody can be asked for: the job goes on later.
TEST_F(LostFileTest, ABucketOutOfReachIsNoLoss) {
  StoreSession("r", {{"left/01.png", "one"}, {"right/01.png", "two"}});
  fs::remove(BlobOf("one"));
  storage::Query(*store_, "INSERT INTO lease_bucket VALUES ('s3://rigs/one', 'id')").Run();
  for (const char* name : {"AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}) setenv(name, "key", 1);
  setenv("AWS_ENDPOINT_URL_S3", "http://127.0.0.1:1", 1);
  storage::StorePlace place = store_->place();
  place.bucket = "s3://rigs/one";
  auto cut_off = storage::Store::Open(place);
  ASSERT_TRUE(cut_off) << Sentence(cut_off.error());
  *store_ = std::move(*cut_off);
  StepAll();
  EXPECT_TRUE(Edges().empty());
  EXPECT_EQ(storage::LoadLost(*store_, 1).value().count, 0);
  EXPECT_EQ(storage::CountJobs(*store_, RobotId("r")).value(), 1);
  EXPECT_TRUE(storage::LoadAttemptCounts(*store_).value().empty());
}

TEST_F(LostFileTest, HealthNamesWhatIsLost) {
  StoreSession("r", {{"left/01.png", "one"}, {"right/01.png", "two"}});
  fs::remove(BlobOf("one"));
  StepAll();
  RevisionCache cache;
  const std::string health = Answer({*store_, clock_, cache, clock_.now, ""}, "health", "{}").value();
  EXPECT_THAT(health, HasSubstr("\"lost_files\":{\"count\":1,\"first\":[{\"path\":\"left/01.png\",\"robot\":\"r\""));
  EXPECT_THAT(health, HasSubstr("\"state\":\"missing\""));
}

// It is not asked for: the server has what it was made from.
TEST_F(LostFileTest, ADamagedPictureOfADetectionIsMadeAgain) {
  auto files = RealPictures();
  if (files.empty()) GTEST_SKIP() << "no stereo_opencv in ../shared/data";
  StoreSession("r", files);
  StepAll();
  ASSERT_EQ(Edges().size(), 1u);
  const Digest picture = Edges().front().evidence.front().digest;
  const fs::path blob = storage::BlobPath(store_->BlobFolder(), picture);
  const fs::path shown = store_->ReportFolder() / "r/1/evidence" / (picture.str() + ".jpg");
  ASSERT_TRUE(fs::exists(shown));
  FlipAByte(blob);
  ASSERT_TRUE(storage::PublishAgain(*store_, RobotId("r")));
  StepAll();
  EXPECT_EQ(Edges().size(), 1u);
  EXPECT_EQ(Sha256OfFile(blob).value(), picture);
  EXPECT_EQ(Sha256OfFile(shown).value(), picture);
  EXPECT_TRUE(fs::exists(blob.string() + ".damaged"));
  EXPECT_EQ(storage::LoadLost(*store_, 1).value().count, 0);
  EXPECT_EQ(revisions_.size(), 1u);
}

}  // namespace
}  // namespace rigcal::pipeline

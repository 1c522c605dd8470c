// What goes out of a store: files that only a bucket has, and edges of many blocks.
#include "server/sites/send.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <mutex>

#include "server/formats/documents.h"
#include "storage/edges/edges.h"
#include "storage/files/blobs.h"
#include "storage/files/lost_blobs.h"
#include "tests/unit/http/client.h"
#include "tests/unit/storage/s3/fixture.h"

namespace rigcal::sites {
namespace {

// Has nothing of a session until the file came, and all of a batch once its last edge came.
class CentreOfOneFile {
 public:
  explicit CentreOfOneFile(const Digest& digest) {
    http::Options options;
    options.logins.of_token = [](const std::string&) -> Result<std::optional<http::Person>> {
      return http::Person{"harbour", Role::kViewer, "*"};
    };
    options.answer_site = [this, digest](const http::SiteRequest& request) -> Result<std::string> {
      RIGCAL_ASSIGN(std::string body, request.read(static_cast<std::size_t>(request.body_bytes)));
      const std::lock_guard lock(mutex_);
      if (request.method == "POST" && request.path.starts_with("/batches/")) {
        RIGCAL_ASSIGN(const formats::EdgeSlice slice, formats::ReadEdgeSlice(body));
        for (const auto& [idx, edge] : slice.items) edges_.push_back(idx);
        ++slices_;
        return formats::WriteForwardReceipt({static_cast<std::int64_t>(edges_.size()) == slice.count});
      }
      if (request.method == "PUT") files_.push_back(body);
      return files_.empty() ? formats::WriteForwardReceipt({false, {digest}}) : formats::WriteForwardReceipt({true});
    };
    server_.emplace(
        std::move(http::Server::Start(options, [](const std::string&, const std::string&) -> Result<http::Page> {
                    return http::Page{};
                  }).value()));
  }
  [[nodiscard]] CentreLink Link() const {
    return {CentreAddress{"http://127.0.0.1:" + std::to_string(server_->port()), "token", ""}, [] { return true; }};
  }
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }
  [[nodiscard]] const std::vector<std::int64_t>& edges() const { return edges_; }
  [[nodiscard]] int slices() const { return slices_; }

 private:
  std::mutex mutex_;
  std::vector<std::string> files_;
  std::vector<std::int64_t> edges_;
  int slices_ = 0;
  std::optional<http::Server> server_;
};

class SendFromBucketTest : public storage::BucketFixture {
 protected:
  storage::TempDatabase database_{folder_.path()};
};

TEST_F(SendFromBucketTest, WhatTheFolderLacksIsFetchedAndSent) {
  storage::StorePlace place = database_.In(folder_.path() / "store");
  place.bucket = place_;
  auto store = storage::Store::Open(place);
  ASSERT_TRUE(store);
  const Digest digest = storage::AppendBlob(store->blobs(), "picture").value();
  Manifest manifest = storage::MakeManifest(1);
  manifest.payloads[0].digest = digest;
  manifest.payloads[0].size_bytes = 7;
  const SessionId id = storage::IdOf(manifest);
  ASSERT_TRUE(storage::AppendSession(*store, id, formats::WriteManifest(manifest), manifest, {5}));
  ASSERT_TRUE(std::filesystem::remove(storage::BlobPath(store->BlobFolder(), digest)));
  const CentreOfOneFile centre(digest);
  EXPECT_EQ(storage::WordsOf(SendSession(*store, centre.Link(), id)), "good");
  EXPECT_THAT(centre.files(), ::testing::ElementsAre("picture"));
}

class SendTest : public storage::StoreTest {
 protected:
  SessionId Hold(const Digest& digest) {
    Manifest manifest = storage::MakeManifest(1);
    manifest.payloads[0].digest = digest;
    manifest.payloads[0].size_bytes = 7;
    const SessionId id = storage::IdOf(manifest);
    EXPECT_TRUE(storage::AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {5}));
    EXPECT_TRUE(storage::AppendHeld(store_, id, {0}, {6}));
    return id;
  }
};

TEST_F(SendTest, AFileThatTheDiskHasLostIsNotedAndNamed) {
  const Digest digest = storage::AppendBlob(store_.blobs(), "picture").value();
  const SessionId session = Hold(digest);
  std::filesystem::remove(storage::BlobPath(store_.BlobFolder(), digest));
  const CentreOfOneFile centre(digest);
  const Status sent = SendSession(store_, centre.Link(), session);
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, ErrorCode::kStorage);
  EXPECT_THAT(sent.error().what, ::testing::AllOf(::testing::HasSubstr("left/100000.png"),
                                                  ::testing::HasSubstr("session " + session.str()),
                                                  ::testing::HasSubstr("robot mapper-01")));
  EXPECT_THAT(sent.error().cure, ::testing::HasSubstr("Push the session again"));
  EXPECT_EQ(storage::LoadLost(store_, 1)->count, 1);
}

TEST_F(SendTest, AFileThatWasCutShortIsSetAsideAndNoted) {
  const Digest digest = storage::AppendBlob(store_.blobs(), "picture").value();
  const SessionId session = Hold(digest);
  std::filesystem::resize_file(storage::BlobPath(store_.BlobFolder(), digest), 3);
  const CentreOfOneFile centre(digest);
  const Status sent = SendSession(store_, centre.Link(), session);
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, ErrorCode::kStorage);
  EXPECT_EQ(storage::LoadLost(store_, 1)->count, 1);
  EXPECT_FALSE(std::filesystem::exists(storage::BlobPath(store_.BlobFolder(), digest)));
}

TEST_F(SendTest, EdgesOfManyBlocksGoFewerAtATime) {
  constexpr std::size_t kBlocks = 20'000;
  std::vector<Edge> edges = {storage::MakeEdge(1), storage::MakeEdge(2), storage::MakeEdge(3)};
  for (Edge& edge : edges) {
    edge.uncertainty.blocks.resize(kBlocks, edge.uncertainty.blocks.front());
    for (std::size_t i = 0; i < kBlocks; ++i) edge.uncertainty.blocks[i].block_id = std::to_string(i);
  }
  const BatchId batch(storage::DigestOf("batch").str());
  const Status stored = store_.Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendRobot(store_, storage::kRobot, {6}));
    RIGCAL_TRY(storage::AppendBatch(store_, storage::kRobot, batch, 3, {6}));
    return storage::AppendBatchItems(store_, batch, {{0, edges[0]}, {1, edges[1]}, {2, edges[2]}}, {6});
  });
  ASSERT_EQ(storage::WordsOf(stored), "good");
  const CentreOfOneFile centre(storage::DigestOf("none"));
  EXPECT_EQ(storage::WordsOf(SendBatch(store_, centre.Link(), batch)), "good");
  EXPECT_THAT(centre.edges(), ::testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(centre.slices(), 3);
}

}  // namespace
}  // namespace rigcal::sites

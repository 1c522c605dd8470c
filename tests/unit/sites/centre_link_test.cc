// The addresses that a site may send to, and what it makes of a centre's answers; over real sockets.
#include "server/sites/centre_link.h"

#include <gmock/gmock.h>

#include <mutex>

#include "server/base/digests/sha256.h"
#include "tests/unit/http/client.h"

namespace rigcal::sites {
namespace {

using ::testing::HasSubstr;

TEST(CentreAddress, IsHttpsOrThisMachine) {
  for (const char* good : {"https://rigs.example.org", "https://127.0.0.1.example.org", "https://10.0.0.2:8420",
                           "http://127.0.0.1:8420", "http://localhost"})
    EXPECT_TRUE(CheckCentre({good, "token", ""})) << good;
  for (const char* bad : {"", "rigs.example.org", "ftp://rigs.example.org", "https://", "https://ada@rigs.example.org",
                          "https://rigs.example.org/path", "https://rigs.example.org/?a=b", "https://rigs example"})
    EXPECT_FALSE(CheckCentre({bad, "token", ""})) << bad;
  EXPECT_FALSE(CheckCentre({"http://127.0.0.1.example.org", "token", ""})) << "it only looks like this machine";
  const Status plain = CheckCentre({"http://rigs.example.org", "token", ""});
  ASSERT_FALSE(plain);
  EXPECT_THAT(plain.error().what, HasSubstr("unprotected"));
  EXPECT_FALSE(CheckCentre({"https://rigs.example.org", "", ""}));
}

class CentreLinkTest : public http::HttpFixture {
 protected:
  void SetUp() override {
    HttpFixture::SetUp();
    options_.logins.of_token = [](const std::string& secret) -> Result<std::optional<http::Person>> {
      return secret == "good" ? std::optional(http::Person{"harbour", Role::kViewer, "*"}) : std::nullopt;
    };
    options_.answer_site = [this](const http::SiteRequest& request) -> Result<std::string> {
      RIGCAL_ASSIGN(std::string body, request.read(static_cast<std::size_t>(request.body_bytes)));
      const std::lock_guard lock(mutex_);
      if (body == "refuse") return Fail(ErrorCode::kConflict, "it belongs to another robot", "Look.");
      if (body == "busy") return Fail(ErrorCode::kBusy, "others are served", "Send it again in a moment.");
      if (request.method == "GET" && request.path == "/batches/" + Sha256Of("lost").str())
        return Fail(ErrorCode::kNotFound, "not all of it is here", "Send it.");
      if (body == "full") return Fail(ErrorCode::kStorage, "the server's disk: it is full", "Make room.");
      taken_.push_back(request.method + " " + request.path + " " + body);
      return formats::WriteForwardReceipt({true});
    };
    url_ = "http://127.0.0.1:" + std::to_string(Start());
  }
  [[nodiscard]] CentreLink Link(const std::string& token = "good") const {
    return {CentreAddress{url_, token, ""}, [] { return true; }};
  }
  CentreLink::BlobFile Blob(const std::string& content) {
    Write("blob-" + content, content);
    return {Sha256Of(content), root_ / ("blob-" + content), static_cast<std::int64_t>(content.size())};
  }

  const SessionId session_{Sha256Of("session").str()};
  std::mutex mutex_;
  std::vector<std::string> taken_;
  std::string url_;
};

TEST_F(CentreLinkTest, SendsManifestsAndFiles) {
  EXPECT_TRUE(Link().Greet());
  EXPECT_TRUE(Link().SendManifest(session_, "{}")->is_whole);
  std::vector<CentreLink::BlobFile> blobs;
  for (int i = 0; i < 40; ++i) blobs.push_back(Blob(std::to_string(i)));
  EXPECT_TRUE(Link().SendBlobs(session_, blobs));
  ASSERT_EQ(taken_.size(), 42u);
  EXPECT_EQ(taken_[0], "GET  ");
  EXPECT_EQ(taken_[1], "POST /sessions/" + session_.str() + " {}");
  std::vector<std::string> wanted, got(taken_.begin() + 2, taken_.end());
  for (int i = 0; i < 40; ++i)
    wanted.push_back("PUT /sessions/" + session_.str() + "/blobs/" + Sha256Of(std::to_string(i)).str() + " " +
                     std::to_string(i));
  EXPECT_THAT(got, ::testing::UnorderedElementsAreArray(wanted));
}

TEST_F(CentreLinkTest, TellsARefusalFromACentreThatTakesNothing) {
  const auto refused = Link().SendManifest(session_, "refuse");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().what, HasSubstr("it belongs to another robot"));
  const auto full = Link().SendManifest(session_, "full");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kUnreachable);
  EXPECT_THAT(full.error().what, HasSubstr("the server's disk: it is full"));
  const auto busy = Link().SendManifest(session_, "busy");
  ASSERT_FALSE(busy);
  EXPECT_EQ(busy.error().code, ErrorCode::kBusy);
  EXPECT_TRUE(Link().HasSession(session_).value());
  EXPECT_FALSE(Link().HasBatch(BatchId(Sha256Of("lost").str())).value());
  EXPECT_FALSE(Link("bad").HasSession(session_));
  const Status stranger = Link("bad").Greet();
  ASSERT_FALSE(stranger);
  EXPECT_EQ(stranger.error().code, ErrorCode::kUnreachable);
  EXPECT_THAT(stranger.error().what, HasSubstr("this takes the token of a site"));
  server_.reset();
  const Status away = Link().Greet();
  ASSERT_FALSE(away);
  EXPECT_EQ(away.error().code, ErrorCode::kUnreachable);
}

TEST_F(CentreLinkTest, OneRefusedFileLetsTheOthersEnd) {
  EXPECT_FALSE(Link().SendBlobs(session_, {Blob("refuse"), Blob("a"), Blob("b")}));
  EXPECT_EQ(taken_.size(), 2u);
}

TEST_F(CentreLinkTest, NamesAFileThatIsGone) {
  const Status lost = Link().SendBlobs(session_, {{Sha256Of("gone"), root_ / "gone", 4}});
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kNotFound);
}

TEST_F(CentreLinkTest, EndsWhenToldTo) {
  const CentreLink ends{CentreAddress{url_, "good", ""}, [] { return false; }};
  EXPECT_FALSE(ends.Greet());
}

}  // namespace
}  // namespace rigcal::sites

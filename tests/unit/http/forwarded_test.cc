// Who may send on what robots pushed elsewhere, and what comes through; through real sockets.
#include <gmock/gmock.h>

#include <condition_variable>
#include <memory>
#include <mutex>

#include "server/base/limits_in_force.h"
#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;

class ForwardedTest : public HttpFixture {
 protected:
  void SetUp() override {
    HttpFixture::SetUp();
    options_.logins.are_needed = [this]() -> Result<bool> { return has_users_; };
    options_.logins.of_session = [](const std::string&) -> Result<std::optional<Person>> { return std::nullopt; };
    options_.logins.of_token = [](const std::string& secret) -> Result<std::optional<Person>> {
      if (secret == "site") return std::optional(Person{"harbour", Role::kViewer, "harbour-*"});
      const auto role = RoleOf(secret);
      return role ? std::optional(Person{"program", *role}) : std::nullopt;
    };
    options_.answer_site = [this](const SiteRequest& request) -> Result<std::string> {
      if (request.path == "/slow") AwaitRelease();
      if (request.path == "/conflict") return Fail(ErrorCode::kConflict, "it belongs to another robot", "Look.");
      std::string body;
      while (true) {
        const auto piece = request.read(3);
        if (!piece) return Fail(piece.error());
        if (piece->empty()) break;
        body += "[" + *piece + "]";
      }
      return request.site.name + " " + request.site.robots + " " + request.method + " " + request.path + " " +
             std::to_string(request.body_bytes) + " " + body;
    };
    port_ = Start([](const std::string&, const std::string&) -> Result<Page> { return Page{"page", "text/plain"}; });
  }
  [[nodiscard]] Reply Send(const std::string& method, const std::string& path, const std::string& token,
                           const std::string& body = "", std::size_t more_bytes = 0) const {
    const Socket socket(port_);
    const std::string bearer = token.empty() ? "" : "Authorization: Bearer " + token + "\r\n";
    const std::string length = "Content-Length: " + std::to_string(body.size() + more_bytes) + "\r\n";
    socket.Send(method + " " + path + " HTTP/1.1\r\nHost: localhost\r\n" + bearer + length + "\r\n" + body);
    if (more_bytes > 0) return {};
    return Parsed(socket.ReadAll());
  }

  void AwaitRelease() {
    std::unique_lock lock(mutex_);
    ++slow_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return is_released_; });
  }
  void AwaitSlow(std::int64_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return slow_ == count; });
  }
  void Release() {
    const std::lock_guard lock(mutex_);
    is_released_ = true;
    changed_.notify_all();
  }

  int port_ = 0;
  bool has_users_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t slow_ = 0;
  bool is_released_ = false;
};

TEST_F(ForwardedTest, TakesTheTokenOfASite) {
  for (const bool has_users : {false, true}) {
    has_users_ = has_users;
    EXPECT_EQ(Send("POST", "/api/v1/forward/sessions/a", "").status, 401);
    EXPECT_EQ(Send("POST", "/api/v1/forward/sessions/a", "wrong").status, 401);
    for (const char* role : {"viewer", "admin"}) {
      const Reply refused = Send("POST", "/api/v1/forward/sessions/a", role);
      EXPECT_EQ(refused.status, 403);
      EXPECT_THAT(refused.body, HasSubstr("this takes the token of a site, and program is " + std::string(role)));
    }
    const Reply taken = Send("POST", "/api/v1/forward/sessions/a", "site", "1234567");
    EXPECT_EQ(taken.status, 200);
    EXPECT_EQ(taken.body, "harbour harbour-* POST /sessions/a 7 [123][456][7]");
  }
}

TEST_F(ForwardedTest, ASiteReadsNothingElse) {
  has_users_ = true;
  for (const char* path : {"/", "/api/v1/robots", "/metrics", "/api/v1/forwarded"}) {
    const Reply refused = Send("GET", path, "site");
    EXPECT_EQ(refused.status, 403) << path;
    EXPECT_THAT(refused.body, HasSubstr("he token of the site harbour reads nothing here"));
  }
  EXPECT_EQ(Send("GET", "/", "viewer").body, "page");
}

TEST_F(ForwardedTest, RefusalsSayWhy) {
  const Reply refused = Send("POST", "/api/v1/forward/conflict", "site");
  EXPECT_EQ(refused.status, 409);
  EXPECT_THAT(refused.body, HasSubstr("it belongs to another robot"));
  const Socket chunked(port_);
  chunked.Send(
      "PUT /api/v1/forward/x HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer site\r\n"
      "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n");
  EXPECT_EQ(Parsed(chunked.ReadAll()).status, 411);
}

TEST_F(ForwardedTest, SitesLeaveThreadsForEverybodyElse) {
  const std::int64_t most = limits::InForce().http_connections / 2;
  std::vector<std::unique_ptr<Socket>> sites;
  for (std::int64_t i = 0; i < most; ++i) {
    sites.push_back(std::make_unique<Socket>(port_));
    sites.back()->Send("GET /api/v1/forward/slow HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer site\r\n\r\n");
  }
  AwaitSlow(most);
  const Reply one_more = Send("GET", "/api/v1/forward", "site");
  EXPECT_EQ(one_more.status, 503);
  EXPECT_THAT(one_more.body, HasSubstr("busy"));
  EXPECT_EQ(Send("GET", "/", "").body, "page");
  Release();
  for (const auto& site : sites) EXPECT_EQ(Parsed(site->ReadAll()).status, 200);
  EXPECT_EQ(Send("GET", "/api/v1/forward", "site").status, 200);
}

TEST_F(ForwardedTest, WhoEndsInTheMiddleHoldsUpNothing) {
  static_cast<void>(Send("PUT", "/api/v1/forward/x", "site", "1234567", 1'000'000));
  EXPECT_EQ(Send("GET", "/api/v1/forward", "site").body, "harbour harbour-* GET  0 ");
}

}  // namespace
}  // namespace rigcal::http

#include <gmock/gmock.h>

#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(HttpFixture, AnswersWithPathAndQuery) {
  const Reply reply = Get(Start(), "/api/v1/lookup?a=x%20y&b=2");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, "path /api/v1/lookup query a=x%20y&b=2");
  EXPECT_EQ(reply.headers.at("content-type"), "text/plain; charset=utf-8");
  EXPECT_EQ(reply.headers.at("content-length"), std::to_string(reply.body.size()));
}

TEST_F(HttpFixture, EveryAnswerCarriesTheSecurityHeaders) {
  const int port = Start();
  for (const Reply& reply :
       {Get(port, "/"), Get(port, "/robots/mapper-01/revisions/7/"), Get(port, "/robots/a/revisions/9/"),
        Ask(port, "POST", "/"), Get(port, "/../x"), Get(port, "/robots/mapper-01"), Ask(port, "NONSENSE", "/")}) {
    EXPECT_THAT(reply.headers.at("content-security-policy"), HasSubstr("default-src 'none'")) << reply.status;
    EXPECT_EQ(reply.headers.at("x-content-type-options"), "nosniff") << reply.status;
    EXPECT_EQ(reply.headers.at("referrer-policy"), "no-referrer") << reply.status;
    EXPECT_EQ(reply.headers.count("cache-control"), 1U) << reply.status;
  }
}

TEST_F(HttpFixture, HeadHasTheSameHeadAndNoBody) {
  const int port = Start();
  for (const std::string target : {"/", "/robots/mapper-01/revisions/7/", "/api/v1/x", "/%zz"}) {
    const Reply get = Get(port, target), head = Ask(port, "HEAD", target);
    EXPECT_EQ(head.status, get.status) << target;
    EXPECT_EQ(head.body, "") << target;
    EXPECT_EQ(head.headers.at("content-length"), std::to_string(get.body.size())) << target;
  }
}

TEST_F(HttpFixture, OtherMethodsAreRefused) {
  const int port = Start();
  for (const std::string method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS"}) {
    const Reply reply = Ask(port, method, "/robots/mapper-01/revisions/7/index.html");
    EXPECT_EQ(reply.status, 405) << method;
    EXPECT_EQ(reply.headers.at("allow"), "GET, HEAD") << method;
  }
  EXPECT_TRUE(std::filesystem::exists(root_ / "reports/mapper-01/7/index.html"));
}

TEST_F(HttpFixture, AnswerIsRevalidatedByItsTag) {
  const int port = Start();
  const std::string tag = Get(port, "/").headers.at("etag");
  EXPECT_EQ(Get(port, "/", "If-None-Match: " + tag + "\r\n").status, 304);
  EXPECT_EQ(Get(port, "/", "If-None-Match: \"other\", W/" + tag + "\r\n").status, 304);
  EXPECT_EQ(Get(port, "/", "If-None-Match: \"other\"\r\n").status, 200);
  EXPECT_EQ(Get(port, "/other", "If-None-Match: " + tag + "\r\n").status, 200);
  EXPECT_EQ(Get(port, "/", "If-None-Match: " + tag + "\r\n").body, "");
}

TEST_F(HttpFixture, ErrorsAreMappedAndShapedByPath) {
  const int port = Start([](const std::string& path, const std::string&) -> Result<Page> {
    if (path.find("missing") != std::string::npos)
      return Fail(ErrorCode::kNotFound, "robot \"<b>\" is not known", "List them.");
    if (path.find("wrong") != std::string::npos) return Fail(ErrorCode::kInvalidInput, "w", "c");
    return Fail(ErrorCode::kStorage, "disk", "c");
  });
  const Reply api = Get(port, "/api/v1/missing"), page = Get(port, "/missing");
  EXPECT_EQ(api.status, 404);
  EXPECT_EQ(api.body, R"({"error":{"code":"not_found","cure":"List them.","what":"robot \"<b>\" is not known"}})");
  EXPECT_THAT(api.headers.at("content-type"), HasSubstr("application/json"));
  EXPECT_EQ(page.status, 404);
  EXPECT_THAT(page.headers.at("content-type"), HasSubstr("text/html"));
  EXPECT_THAT(page.body, HasSubstr("Robot &quot;&lt;b&gt;&quot; is not known."));
  EXPECT_THAT(page.body, HasSubstr("List them."));
  EXPECT_EQ(Get(port, "/api/v1/wrong").status, 400);
  EXPECT_EQ(Get(port, "/api/v1/x").status, 503);
}

TEST_F(HttpFixture, AnswerMayHaveAnotherStatus) {
  const Reply reply = Get(Start([](const std::string&, const std::string&) -> Result<Page> {
                            return Page{"{\"state\":\"failing\"}", "application/json", {}, false, 503};
                          }),
                          "/healthz");
  EXPECT_EQ(reply.status, 503);
  EXPECT_EQ(reply.body, "{\"state\":\"failing\"}");
  EXPECT_EQ(reply.headers.at("cache-control"), "no-store");
}

TEST_F(HttpFixture, MissingFileSaysWhatTheAnswerSays) {
  Error why{ErrorCode::kBusy, "it is being drawn again", "Wait."};
  const int port = Start([&](const std::string& path, const std::string&) -> Result<Page> {
    EXPECT_EQ(path, "/robots/mapper-01/revisions/8/");
    return Fail(why);
  });
  const Reply busy = Get(port, "/robots/mapper-01/revisions/8/");
  EXPECT_EQ(busy.status, 503);
  EXPECT_EQ(busy.headers.at("retry-after"), "2");
  EXPECT_THAT(busy.body, HasSubstr("It is being drawn again."));
  why = {ErrorCode::kNotFound, "it could not be drawn: a blob is gone", "Restore it."};
  const Reply gone = Get(port, "/robots/mapper-01/revisions/8/");
  EXPECT_EQ(gone.status, 404);
  EXPECT_EQ(gone.headers.count("retry-after"), 0U);
  EXPECT_THAT(gone.body, HasSubstr("It could not be drawn: a blob is gone."));
  EXPECT_EQ(Get(port, "/robots/mapper-01/revisions/7/").body, "<p>seven</p>");
}

TEST_F(HttpFixture, ExceptionOfTheAnswerIsAnError) {
  const int port =
      Start([](const std::string&, const std::string&) -> Result<Page> { throw std::runtime_error("boom"); });
  const Reply reply = Get(port, "/api/v1/x");
  EXPECT_EQ(reply.status, 503);
  EXPECT_THAT(reply.body, Not(HasSubstr("boom")));
  EXPECT_EQ(Get(port, "/").status, 503);
}

TEST_F(HttpFixture, AnswerMayRedirect) {
  const int port = Start([](const std::string&, const std::string&) -> Result<Page> {
    return Page{"", "", "/robots/mapper-01/revisions/7/"};
  });
  const Reply reply = Get(port, "/robots/mapper-01/revisions/latest/");
  EXPECT_EQ(reply.status, 302);
  EXPECT_EQ(reply.headers.at("location"), "/robots/mapper-01/revisions/7/");
}

TEST_F(HttpFixture, PortInUseIsAnErrorWithTheAddress) {
  options_.port = Start();
  const auto second = Server::Start(options_, [](const auto&, const auto&) -> Result<Page> { return Page{}; });
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().what, HasSubstr("127.0.0.1:" + std::to_string(options_.port)));
}

TEST_F(HttpFixture, AddressThatIsNoneIsRefused) {
  for (const std::string host : {"", "127.0.0.1:80,0.0.0.0", "a b", "x\r\ny"}) {
    Options options = options_;
    options.host = host;
    EXPECT_FALSE(Server::Start(options, [](const auto&, const auto&) -> Result<Page> { return Page{}; })) << host;
  }
}

TEST_F(HttpFixture, ListensOnLoopbackOnly) {
  const int port = Start();
  std::ifstream table("/proc/net/tcp");
  std::array<char, 8> hex{};
  std::snprintf(hex.data(), hex.size(), ":%04X", static_cast<unsigned>(port));
  std::string line, listening;
  while (std::getline(table, line))
    if (line.find(std::string(hex.data()) + " 00000000:0000 0A") != std::string::npos)
      listening += line.substr(6, 8) + " ";
  EXPECT_EQ(listening, "0100007F ");
}

TEST_F(HttpFixture, PortIsFreeAgainAfterTheEnd) {
  const int port = Start();
  server_.reset();
  EXPECT_FALSE(Socket(port).connected());
}

}  // namespace
}  // namespace rigcal::http

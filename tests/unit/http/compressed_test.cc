#include <gmock/gmock.h>
#include <zlib.h>

#include "server/http/compressed_bodies.h"
#include "server/http/conditions.h"
#include "server/http/pages/open_notice.h"
#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kPage = "/robots/mapper-01/revisions/7/";

std::string Unpacked(const std::string& gzip) {
  z_stream stream{};
  std::string text(1 << 20, '\0');
  if (inflateInit2(&stream, 15 + 16) != Z_OK) return "no zlib";
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  const bool is_whole = inflate(&stream, Z_FINISH) == Z_STREAM_END;
  text.resize(is_whole ? stream.total_out : 0);
  inflateEnd(&stream);
  return text;
}

TEST(Compressed, IsAskedForByName) {
  for (const char* header : {"gzip", "GZIP", "br, gzip;q=0.5", "deflate,gzip", "*", "*;q=0.1", "gzip ; q=1.0"})
    EXPECT_TRUE(AcceptsGzip(header)) << header;
  for (const char* header : {"", "identity", "br", "gzip;q=0", "gzip;q=0.000", "*;q=0", "gzip;q=0, *", "gzipx", ",,;"})
    EXPECT_FALSE(AcceptsGzip(header)) << header;
}

TEST(Compressed, IsTextOfASizeThatIsWorthIt) {
  EXPECT_TRUE(IsWorthCompressing("text/html; charset=utf-8", 5000));
  EXPECT_TRUE(IsWorthCompressing("application/json", 5000));
  EXPECT_TRUE(IsWorthCompressing("image/svg+xml", 5000));
  EXPECT_FALSE(IsWorthCompressing("image/jpeg", 5000));
  EXPECT_FALSE(IsWorthCompressing("text/html", 100));
  EXPECT_FALSE(IsWorthCompressing("text/html", 100 << 20));
}

TEST(Compressed, IsMadeOnceAndForgottenBeyondItsLimit) {
  int reads = 0;
  const auto body = [&reads] {
    ++reads;
    return std::string(5000, 'x');
  };
  CompressedBodies bodies(Gzip(std::string(5000, 'x')).size());  // of one
  EXPECT_EQ(Unpacked(*bodies.Of("a", body)), std::string(5000, 'x'));
  EXPECT_NE(bodies.Of("a", body), nullptr);
  EXPECT_EQ(reads, 1);
  EXPECT_NE(bodies.Of("b", body), nullptr);
  EXPECT_NE(bodies.Of("a", body), nullptr);
  EXPECT_EQ(reads, 3);
  EXPECT_EQ(bodies.Of("c", [] { return std::string(); }), nullptr);
}

TEST_F(HttpFixture, FilesAndAnswersAreCompressedForThoseWhoTakeIt) {
  const std::string text(20'000, 'p');
  Write("reports/mapper-01/7/index.html", text);
  const int port = Start([&](const std::string&, const std::string&) -> Result<Page> {
    return Page{text, "text/css"};
  });
  for (const std::string& target : {kPage, std::string("/style.css")}) {
    const Reply plain = Get(port, target), packed = Get(port, target, "Accept-Encoding: br, gzip\r\n");
    EXPECT_EQ(plain.body, text);
    EXPECT_EQ(plain.headers.count("content-encoding"), 0U);
    EXPECT_EQ(plain.headers.at("vary"), "Accept-Encoding");
    EXPECT_EQ(packed.headers.at("content-encoding"), "gzip");
    EXPECT_EQ(packed.headers.at("vary"), "Accept-Encoding");
    EXPECT_EQ(packed.headers.at("content-length"), std::to_string(packed.body.size()));
    EXPECT_LT(packed.body.size(), 1000U);
    EXPECT_EQ(Unpacked(packed.body), text);
    const std::string tag = packed.headers.at("etag");
    EXPECT_NE(tag, plain.headers.at("etag"));
    EXPECT_EQ(Get(port, target, "Accept-Encoding: gzip\r\nIf-None-Match: " + tag + "\r\n").status, 304);
    EXPECT_EQ(Get(port, target, "If-None-Match: " + tag + "\r\n").status, 200);
    EXPECT_EQ(Ask(port, "HEAD", target, "Accept-Encoding: gzip\r\n").headers.at("content-length"),
              packed.headers.at("content-length"));
  }
  const Reply part = Get(port, kPage, "Accept-Encoding: gzip\r\nRange: bytes=0-9\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, "pppppppppp");
}

TEST_F(HttpFixture, CompressedFileThatIsWrittenAnewIsNew) {
  Write("reports/mapper-01/7/index.html", std::string(5000, 'a'));
  const int port = Start();
  EXPECT_EQ(Unpacked(Get(port, kPage, "Accept-Encoding: gzip\r\n").body), std::string(5000, 'a'));
  Write("reports/mapper-01/7/index.html", std::string(6000, 'b'));
  EXPECT_EQ(Unpacked(Get(port, kPage, "Accept-Encoding: gzip\r\n").body), std::string(6000, 'b'));
}

TEST_F(HttpFixture, OpenServerSaysSoOnEveryPage) {
  Write("reports/mapper-01/7/index.html", "<body><main class=\"x\">seven</main></body>");
  const auto answer = [](const std::string& path, const std::string&) -> Result<Page> {
    if (path == "/none") return Fail(ErrorCode::kNotFound, "nothing", "c");
    return Page{"<body>page</body>", path == "/text" ? "text/plain" : "text/html"};
  };
  const int closed = Start(answer);
  EXPECT_THAT(Get(closed, kPage).body, Not(HasSubstr("Anyone on this network")));
  server_.reset();
  options_.is_open = true;
  const int open = Start(answer);
  for (const std::string& target : {kPage, std::string("/"), std::string("/none"), std::string("/../x")}) {
    EXPECT_THAT(Get(open, target).body, HasSubstr("Anyone on this network can read these pages")) << target;
    EXPECT_EQ(Get(open, target).headers.at("content-length"), std::to_string(Get(open, target).body.size())) << target;
  }
  EXPECT_THAT(Get(open, "/text").body, Not(HasSubstr("Anyone")));
  EXPECT_EQ(WithOpenNotice("no tags"), "no tags");
}

TEST_F(HttpFixture, NoteIsOnEveryPageAndNowhereElse) {
  Write("reports/mapper-01/7/index.html", "<body><main class=\"x\">seven</main></body>");
  options_.note = "Anyone on the network can push & give orders.";
  const int port = Start([](const std::string& path, const std::string&) -> Result<Page> {
    if (path == "/none") return Fail(ErrorCode::kNotFound, "nothing", "c");
    return Page{"<body>page</body>", path == "/text" ? "text/plain" : "text/html"};
  });
  for (const std::string& target : {kPage, std::string("/"), std::string("/none")})
    EXPECT_THAT(Get(port, target).body, HasSubstr("push &amp; give orders.</p>")) << target;
  EXPECT_THAT(Get(port, "/text").body, Not(HasSubstr("give orders")));
}

}  // namespace
}  // namespace rigcal::http

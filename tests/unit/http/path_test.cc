#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/conditions.h"
#include "server/http/error_body.h"
#include "server/http/request_path.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(HttpPath, IsDecodedAndNormal) {
  EXPECT_EQ(NormalPath("/").value(), "/");
  EXPECT_EQ(NormalPath("//").value(), "/");
  EXPECT_EQ(NormalPath("/a//b/").value(), "/a/b/");
  EXPECT_EQ(NormalPath("/a%20b%2Fc").value(), "/a b/c");
  EXPECT_EQ(NormalPath("/a+b").value(), "/a+b");
}

TEST(HttpPath, IsRefused) {
  for (const std::string raw : {"", "a", "/..", "/a/../b", "/a/./b", "/.a", "/%2e%2e/", "/%zz", "/%", "/%4", "/a%00b",
                                "/a%0d%0ab", "/a\\b", "/a%5cb", "/a%7f"})
    EXPECT_FALSE(NormalPath(raw)) << raw;
}

TEST(HttpPath, PublishedFile) {
  EXPECT_EQ(PublishedFile("/robots/m/revisions/7/").value(), "m/7/index.html");
  EXPECT_EQ(PublishedFile("/robots/m/revisions/7/evidence/a.jpg").value(), "m/7/evidence/a.jpg");
  EXPECT_EQ(PublishedFile("/robots/m/revisions/7/evidence/certificate.html").value(), "m/7/evidence/certificate.html");
  for (const std::string path : {"/", "/robots/m/", "/robots/m/revisions/7/certificate.html",
                                 "/robots/m/revisions/latest/", "/robots/m/revisions/07/", "/robots/m/revisions/0/",
                                 "/robots/-m/revisions/7/", "/robots/m/revisions/9999999999/", "/x/m/revisions/7/"})
    EXPECT_FALSE(PublishedFile(path)) << path;
}

TEST(HttpPath, PagesWithoutTheirLastSlash) {
  EXPECT_EQ(WithSlash("/experiments").value(), "/experiments/");
  EXPECT_EQ(WithSlash("/boards").value(), "/boards/");
  EXPECT_EQ(WithSlash("/experiments/noise").value(), "/experiments/noise/");
  EXPECT_EQ(WithSlash("/robots/m").value(), "/robots/m/");
  EXPECT_EQ(WithSlash("/models").value(), "/models/");
  EXPECT_EQ(WithSlash("/models/mars-mapper").value(), "/models/mars-mapper/");
  for (const std::string path : {"/", "/experiments/", "/experiments/noise/experiment.json", "/x", "/robots"})
    EXPECT_FALSE(WithSlash(path)) << path;
}

TEST(HttpConditions, Tags) {
  EXPECT_TRUE(MatchesTag("*", "\"a\""));
  EXPECT_TRUE(MatchesTag(" \"b\" , W/\"a\"", "\"a\""));
  EXPECT_FALSE(MatchesTag("\"ab\"", "\"a\""));
  EXPECT_FALSE(MatchesTag("", "\"a\""));
  EXPECT_FALSE(MatchesTag(",,", "\"a\""));
}

TEST(HttpConditions, RangeOfAnEmptyFile) {
  EXPECT_EQ(ParseRange("bytes=0-", 0).kind, RangeKind::kUnsatisfiable);
  EXPECT_EQ(ParseRange("bytes=-5", 0).kind, RangeKind::kUnsatisfiable);
  EXPECT_EQ(ParseRange("lines=0-", 10).kind, RangeKind::kWhole);
  EXPECT_EQ(ParseRange("bytes=-0", 10).kind, RangeKind::kUnsatisfiable);
}

TEST(HttpPath, RobotAbove) {
  EXPECT_EQ(RobotAbove("/robots/m/revisions/7/"), "m");
  EXPECT_EQ(RobotAbove("/robots/m/compare"), "m");
  for (const std::string path : {"/", "/robots/m/", "/robots/-m/revisions/7/", "/x/m/revisions/7/"})
    EXPECT_EQ(RobotAbove(path), "") << path;
}

TEST(HttpErrors, PageIsASentenceWithAWayOn) {
  const Error error{ErrorCode::kNotFound, "robot '<b>' is not known", "`rigcal robots` lists those that are"};
  const std::string page = ErrorPage(404, error, "mapper-01");
  EXPECT_THAT(page, HasSubstr("Robot &#39;&lt;b&gt;&#39; is not known.</p>"));
  EXPECT_THAT(page, HasSubstr("<code>rigcal robots</code> lists those that are.</p>"));
  EXPECT_THAT(page, HasSubstr("href=\"/robots/mapper-01/\">mapper-01</a>"));
  EXPECT_THAT(ErrorPage(404, error), Not(HasSubstr("/robots/")));
}

TEST(HttpErrors, DocumentKeepsBrokenText) {
  EXPECT_EQ(ErrorDocument({ErrorCode::kNotFound, "a\"\n\xff", "c"}),
            "{\"error\":{\"code\":\"not_found\",\"cure\":\"c\",\"what\":\"a\\\"\\n\xEF\xBF\xBD\"}}");
}

}  // namespace
}  // namespace rigcal::http

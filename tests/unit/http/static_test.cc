#include <gmock/gmock.h>

#include "server/http/open_below.h"
#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kRevision = "/robots/mapper-01/revisions/7/";

TEST_F(HttpFixture, FolderIsServedWithTypes) {
  const int port = Start();
  const Reply page = Get(port, kRevision);
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<p>seven</p>");
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_EQ(Get(port, kRevision + "index.html").body, "<p>seven</p>");
  EXPECT_EQ(Get(port, kRevision + "style.css").headers.at("content-type"), "text/css; charset=utf-8");
  EXPECT_THAT(Get(port, kRevision + "revision.json").headers.at("content-type"), HasSubstr("json"));
  EXPECT_EQ(Get(port, kRevision + "evidence/ab.jpg").headers.at("content-type"), "image/jpeg");
}

TEST_F(HttpFixture, PicturesAreKeptByTheBrowserPagesAreNot) {
  const int port = Start();
  EXPECT_THAT(Get(port, kRevision + "evidence/ab.jpg").headers.at("cache-control"), HasSubstr("immutable"));
  EXPECT_EQ(Get(port, kRevision).headers.at("cache-control"), "no-cache");
}

TEST_F(HttpFixture, ScriptsNamedByTheirContentAreKept) {
  Write("reports/mapper-01/7/assets/rig-0123456789ab.js", "1");
  const int port = Start([](const std::string& path, const std::string&) -> Result<Page> {
    return Page{"2", "text/javascript; charset=utf-8", {}, path == "/assets/x.js"};
  });
  const Reply published = Get(port, kRevision + "assets/rig-0123456789ab.js");
  EXPECT_THAT(published.headers.at("cache-control"), HasSubstr("immutable"));
  EXPECT_THAT(published.headers.at("content-type"), HasSubstr("javascript"));
  EXPECT_THAT(Get(port, "/assets/x.js").headers.at("cache-control"), HasSubstr("immutable"));
  EXPECT_EQ(Get(port, "/other").headers.at("cache-control"), "no-cache");
}

TEST_F(HttpFixture, FileIsRevalidatedByItsTag) {
  const int port = Start();
  const std::string tag = Get(port, kRevision).headers.at("etag");
  const Reply same = Get(port, kRevision, "If-None-Match: " + tag + "\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.body, "");
  Write("reports/mapper-01/7/index.html", "<p>rendered anew</p>");
  EXPECT_EQ(Get(port, kRevision, "If-None-Match: " + tag + "\r\n").body, "<p>rendered anew</p>");
}

TEST_F(HttpFixture, Ranges) {
  const int port = Start();
  const auto part = [port](const std::string& range) {
    return Get(port, kRevision + "revision.json", "Range: bytes=" + range + "\r\n");
  };
  EXPECT_EQ(part("2-4").status, 206);
  EXPECT_EQ(part("2-4").body, "234");
  EXPECT_EQ(part("2-4").headers.at("content-range"), "bytes 2-4/10");
  EXPECT_EQ(part("7-").body, "789");
  EXPECT_EQ(part("-2").body, "89");
  EXPECT_EQ(part("8-100").body, "89");
  EXPECT_EQ(part("8-100").headers.at("content-length"), "2");
  EXPECT_EQ(part("10-").status, 416);
  EXPECT_EQ(part("10-").headers.at("content-range"), "bytes */10");
  EXPECT_EQ(part("4-2").status, 200);
  EXPECT_EQ(part("0-1,4-5").status, 200);
  EXPECT_EQ(part("99999999999999999999-").status, 200);
}

TEST_F(HttpFixture, RangeOfAnotherVersionIsTheWholeFile) {
  const int port = Start();
  const Reply reply = Get(port, kRevision + "revision.json", "Range: bytes=2-4\r\nIf-Range: \"old\"\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, "0123456789");
}

TEST_F(HttpFixture, EmptyAndLargeFiles) {
  std::string large(5'000'000, 'x');
  large.back() = 'y';
  Write("reports/mapper-01/7/large.bin", large);
  Write("reports/mapper-01/7/empty.txt", "");
  const int port = Start();
  EXPECT_EQ(Get(port, kRevision + "large.bin").body, large);
  const Reply empty = Get(port, kRevision + "empty.txt");
  EXPECT_EQ(empty.status, 200);
  EXPECT_EQ(empty.headers.at("content-length"), "0");
}

TEST_F(HttpFixture, AddressWithoutLastSlashIsMended) {
  const int port = Start();
  EXPECT_EQ(Get(port, "/robots/mapper-01/revisions/7").headers.at("location"), kRevision);
  EXPECT_EQ(Get(port, "/robots/mapper-01").headers.at("location"), "/robots/mapper-01/");
}

TEST_F(HttpFixture, WhatIsNotThereIsAFriendlyPage) {
  const int port = Start();
  for (const std::string& target :
       {kRevision + "nothing", kRevision + "evidence/", kRevision + "evidence",
        std::string("/robots/mapper-01/revisions/8/"), std::string("/robots/other/revisions/1/")}) {
    const Reply reply = Get(port, target);
    EXPECT_EQ(reply.status, 404) << target;
    EXPECT_THAT(reply.body, HasSubstr("There is nothing here")) << target;
  }
  EXPECT_THAT(Get(port, "/robots/mapper-01/revisions/8/").body,
              HasSubstr("There is no report of revision 8 of mapper-01."));
  EXPECT_THAT(Get(port, kRevision + "nothing").body,
              HasSubstr("The report of revision 7 of mapper-01 has no file nothing."));
}

TEST_F(HttpFixture, NothingOutsideTheFolderAndNothingHidden) {
  const int port = Start();
  for (const std::string target :
       {"../../../outside.txt", "%2e%2e/%2e%2e/%2e%2e/outside.txt", "..%2f..%2f..%2foutside.txt",
        "..%5c..%5coutside.txt", "%252e%252e/outside.txt", ".hidden", "%2ehidden", "./.hidden", "evidence/../.hidden",
        "..%00/x", "index.html%00.jpg", "../.new-8/index.html", "....//....//outside.txt",
        "%c0%ae%c0%ae/outside.txt"}) {
    const Reply reply = Get(port, kRevision + target);
    EXPECT_TRUE(reply.status == 400 || reply.status == 404) << target << ": " << reply.status;
    EXPECT_THAT(reply.body, Not(HasSubstr("secret"))) << target;
  }
  for (const std::string target :
       {"/robots/../revisions/7/index.html", "/robots/.new/revisions/1/", "//etc/passwd",
        "/robots/mapper-01/revisions/.new-8/index.html", "/robots/mapper-01/revisions/07/index.html"})
    EXPECT_THAT(Get(port, target).body, Not(HasSubstr("secret"))) << target;
}

TEST_F(HttpFixture, WithoutAFolderNoFileIsServed) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(options_.folder);
  options_.folder.clear();
  const Reply reply = Get(Start(), kRevision);
  std::filesystem::current_path(before);
  EXPECT_EQ(reply.status, 404);
  EXPECT_THAT(reply.body, Not(HasSubstr("seven")));
}

TEST_F(HttpFixture, LinksLeadNowhere) {
  const std::filesystem::path revision = options_.folder / "mapper-01/7";
  std::filesystem::create_symlink(root_ / "outside.txt", revision / "link.txt");
  std::filesystem::create_symlink("revision.json", revision / "near.json");
  std::filesystem::create_directory_symlink(root_, revision / "up");
  std::filesystem::create_directory_symlink(root_ / "reports/mapper-01", options_.folder / "other");
  const int port = Start();
  for (const std::string& target : {kRevision + "link.txt", kRevision + "near.json", kRevision + "up/outside.txt",
                                    std::string("/robots/other/revisions/7/")})
    EXPECT_EQ(Get(port, target).status, 404) << target;
  EXPECT_EQ(Get(port, kRevision + "revision.json").body, "0123456789");
}

TEST_F(HttpFixture, FolderItselfMayBeALink) {
  std::filesystem::create_directory_symlink(options_.folder, root_ / "elsewhere");
  options_.folder = root_ / "elsewhere";
  EXPECT_EQ(Get(Start(), kRevision).body, "<p>seven</p>");
}

TEST_F(HttpFixture, BothWaysToOpenRefuseTheSame) {
  const std::filesystem::path folder = options_.folder;
  std::filesystem::create_symlink(root_ / "outside.txt", folder / "mapper-01/7/link.txt");
  std::filesystem::create_directory_symlink(root_, folder / "mapper-01/up");
  for (const auto open : {OpenBelow, OpenStepwiseBelow}) {
    EXPECT_GE(open(folder, "mapper-01/7/index.html").get(), 0);
    for (const std::string file : {"mapper-01/7/link.txt", "mapper-01/up/outside.txt", "../outside.txt",
                                   "mapper-01/../../outside.txt", "", ".", "mapper-01/7/", "none/x", "/etc/passwd"})
      EXPECT_LT(open(folder, file).get(), 0) << file;
    EXPECT_LT(open("", "etc/passwd").get(), 0);
    EXPECT_LT(open(folder / "none", "x").get(), 0);
  }
}

}  // namespace
}  // namespace rigcal::http

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "client/wire/session_outlet.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

class FilePiecesTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_ / "left");
    Write("left/01.png", "0123456789abcdef");
    Write("left/02.png", "zz");
  }

  void Write(const std::string& path, const std::string& bytes) { std::ofstream(folder_ / path) << bytes; }
  FilePieces Pieces() {
    Payload first, second;
    first.path = "left/01.png";
    first.size_bytes = 16;
    second.path = "left/02.png";
    second.size_bytes = 2;
    return FilePieces(folder_, {first, second}, MarkFiles(folder_));
  }

  TempFolder place_;
  const fs::path folder_ = place_.path();
};

TEST_F(FilePiecesTest, ReadsThePieceThatIsAskedFor) {
  FilePieces pieces = Pieces();
  EXPECT_EQ(**pieces.Read({0, 10, 6}), "abcdef");
  EXPECT_EQ(**pieces.Read({1, 0, 2}), "zz");
  EXPECT_EQ(**pieces.Read({0, 0, 4}), "0123");
  EXPECT_TRUE(pieces.CheckAll());
}

TEST_F(FilePiecesTest, AFileThatGrewOrShrankIsNamed) {
  for (const char* bytes : {"0123456789abcdefX", "0123"}) {
    Write("left/01.png", "0123456789abcdef");
    FilePieces pieces = Pieces();
    Write("left/01.png", bytes);
    const auto piece = pieces.Read({0, 0, 10});
    ASSERT_FALSE(piece);
    EXPECT_NE(piece.error().what.find("left/01.png changed"), std::string::npos);
    EXPECT_EQ(piece.error().code, ErrorCode::kInvalidInput);
  }
}

TEST_F(FilePiecesTest, ARewriteOfTheSameLengthIsNoticedByItsTime) {
  FilePieces pieces = Pieces();
  const timespec times[2] = {{1, 0}, {1'000'000'000, 5}};
  ASSERT_EQ(utimensat(AT_FDCWD, (folder_ / "left/02.png").c_str(), times, 0), 0);
  EXPECT_TRUE(pieces.Read({0, 0, 4}));
  EXPECT_FALSE(pieces.Read({1, 0, 2}));
  EXPECT_FALSE(pieces.CheckAll());
}

TEST_F(FilePiecesTest, AReplacedFileIsNoticed) {
  FilePieces pieces = Pieces();
  EXPECT_TRUE(pieces.Read({0, 0, 4}));
  Write("left/new", "0123456789abcdef");
  fs::rename(folder_ / "left/new", folder_ / "left/01.png");
  EXPECT_FALSE(pieces.Read({0, 4, 4}));
}

TEST_F(FilePiecesTest, AFileThatVanishedIsNamed) {
  FilePieces pieces = Pieces();
  fs::remove(folder_ / "left/02.png");
  const auto piece = pieces.Read({1, 0, 2});
  ASSERT_FALSE(piece);
  EXPECT_NE(piece.error().what.find("left/02.png"), std::string::npos);
  EXPECT_FALSE(pieces.CheckAll());
}

TEST_F(FilePiecesTest, MarksOfAFolderThatDoesNotExistAreEmpty) { EXPECT_TRUE(MarkFiles(folder_ / "no").empty()); }

}  // namespace
}  // namespace rigcal::client

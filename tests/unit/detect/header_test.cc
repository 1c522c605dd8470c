#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "server/detect/pictures/grey_image.h"
#include "server/detect/pictures/image_header.h"

namespace rigcal::detect {
namespace {

using testing::HasSubstr;

Result<ImageSize> SizeOf(const std::string& bytes) { return ReadImageSize(std::as_bytes(std::span(bytes))); }

std::string BigEndian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>((value >> (8 * i)) & 0xFF);
  return text;
}

std::string Png(std::uint32_t width, std::uint32_t height) {
  return std::string("\x89PNG\r\n\x1a\n", 8) + BigEndian(13, 4) + "IHDR" + BigEndian(width, 4) + BigEndian(height, 4);
}

std::string Segment(char marker, const std::string& content) {
  return std::string("\xFF") + marker + BigEndian(static_cast<std::uint32_t>(content.size() + 2), 2) + content;
}

std::string Frame(char marker, std::uint32_t width, std::uint32_t height) {
  return Segment(marker, "\x08" + BigEndian(height, 2) + BigEndian(width, 2) + "\x01");
}

const std::string kJpeg = "\xFF\xD8";

TEST(ImageHeader, ReadsPng) { EXPECT_EQ(*SizeOf(Png(640, 480)), (ImageSize{640, 480})); }

TEST(ImageHeader, ReadsJpegBehindOtherSegments) {
  // The huffman table's marker lies among the frames' markers, and its content looks like a frame.
  const std::string table = Segment('\xC4', Frame('\xC0', 1, 2));
  EXPECT_EQ(*SizeOf(kJpeg + Segment('\xE1', "Exif") + table + "\xFF" + Frame('\xC2', 640, 480)), (ImageSize{640, 480}));
}

bool CutOff(const std::string& bytes) { return IsCutOff(std::as_bytes(std::span(bytes))); }

TEST(ImageHeader, AJpegNeedsItsEnd) {
  const std::string end = "\xFF\xD9", frame = Frame('\xC0', 640, 480), data(100, 'x');
  EXPECT_FALSE(CutOff(kJpeg + frame + data + end));
  EXPECT_FALSE(CutOff(kJpeg + frame + data + end + "behind it"));
  EXPECT_TRUE(CutOff(kJpeg + frame + data));
  EXPECT_TRUE(CutOff(kJpeg + frame + data + "\xFF"));
  EXPECT_TRUE(CutOff(kJpeg + Segment('\xE1', "preview" + end) + frame + data));
  EXPECT_TRUE(CutOff(kJpeg + "\xFF"));
}

TEST(ImageHeader, RefusesMoreThanTheLimit) {
  const auto size = SizeOf(Png(0xFFFFFFFF, 0xFFFFFFFF));
  ASSERT_FALSE(size);
  EXPECT_THAT(size.error().what, HasSubstr("the size in its header is impossible"));
  EXPECT_THAT(SizeOf(Png(100'000, 50'000)).error().what,
              HasSubstr("100000 x 50000 pixels, more than the limit of 200 megapixels"));
  EXPECT_TRUE(SizeOf(Png(20'000, 10'000)));
  EXPECT_FALSE(SizeOf(Png(20'000, 10'001)));
}

TEST(GreyImage, RefusesASizeThatItsBytesCannotHold) {
  for (const std::string& encoded : {Png(14'000, 14'000), kJpeg + Frame('\xC2', 14'000, 14'000)}) {
    const auto image = DecodeGrey(std::as_bytes(std::span(encoded)));
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error().what, HasSubstr("14000 x 14000 pixels, which its"));
  }
}

TEST(ImageHeader, RefusesEmptyPictures) {
  EXPECT_FALSE(SizeOf(Png(0, 480)));
  EXPECT_FALSE(SizeOf(kJpeg + Frame('\xC0', 640, 0)));
}

TEST(ImageHeader, RefusesEveryTruncation) {
  for (const std::string& whole : {Png(640, 480), kJpeg + Segment('\xE0', "JFIF") + Frame('\xC0', 640, 480)}) {
    const std::size_t needed = whole.size() - (whole[0] == '\x89' ? 0 : 1);
    for (std::size_t size = 0; size < needed; ++size) EXPECT_FALSE(SizeOf(whole.substr(0, size))) << size;
  }
}

TEST(ImageHeader, SegmentsOfNoLengthEnd) {
  std::string bytes = kJpeg;
  for (int i = 0; i < 1000; ++i) bytes += std::string("\xFF\xE0\x00\x00", 4);
  EXPECT_FALSE(SizeOf(bytes));
}

TEST(ImageHeader, RefusesOtherFormats) {
  const auto size = SizeOf("BM this is a bitmap");
  ASSERT_FALSE(size);
  EXPECT_THAT(size.error().what, HasSubstr("neither PNG nor JPEG"));
}

Result<Picture> ColourOf(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return DecodeColour(std::as_bytes(std::span(bytes)));
}

TEST(ColourPicture, KeepsColoursAndTheirOrder) {
  cv::Mat3b bgr(2, 3, cv::Vec3b(10, 20, 30));
  bgr(1, 2) = {1, 2, 250};
  const auto picture = ColourOf(bgr);
  ASSERT_TRUE(picture) << Sentence(picture.error());
  EXPECT_EQ(picture->width_px, 3);
  EXPECT_EQ(picture->height_px, 2);
  ASSERT_EQ(picture->rgb.size(), 18u);
  EXPECT_EQ(std::vector<std::uint8_t>(picture->rgb.begin(), picture->rgb.begin() + 3),
            (std::vector<std::uint8_t>{30, 20, 10}));
  EXPECT_EQ(picture->rgb[15], 250);
}

TEST(ColourPicture, GreyHasThreeEqualColours) {
  const auto picture = ColourOf(cv::Mat1b(4, 4, 77));
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->rgb, std::vector<std::uint8_t>(48, 77));
}

// 12 bits of 16, as cameras leave them: stretched, red stays red.
TEST(ColourPicture, DeepPicturesAreStretchedByOneScale) {
  cv::Mat deep(10, 10, CV_16UC3, cv::Scalar(0, 1000, 4000));
  const auto picture = ColourOf(deep);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->rgb[0], 255);
  EXPECT_NEAR(picture->rgb[1], 64, 1);
  EXPECT_EQ(picture->rgb[2], 0);
}

TEST(ColourPicture, RefusesWhatIsNone) {
  const std::string bytes = Png(640, 480);
  EXPECT_FALSE(DecodeColour(std::as_bytes(std::span(bytes))));
}

}  // namespace
}  // namespace rigcal::detect

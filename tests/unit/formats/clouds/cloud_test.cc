#include <limits>
#include <span>
#include <tuple>

#include "server/base/limits.h"
#include "tests/unit/formats/clouds/cloud_samples.h"

namespace rigcal::formats {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();
using Points = std::vector<Eigen::Vector3f>;

const Points kTwo = {{1.0f, 2.0f, 3.0f}, {-4.5f, 0.0f, 6.25f}};
const std::string kTwoText = "1 2 3\n-4.5 0 6.25\n";
const std::string kTwoBytes = Floats(1, 2, 3, -4.5, 0, 6.25);

Cloud Good(const std::string& bytes, std::string_view suffix) {
  auto cloud = ReadText(bytes, suffix);
  EXPECT_TRUE(cloud) << Sentence(cloud.error());
  return cloud ? *cloud : Cloud();
}

void ExpectTwo(const std::string& bytes, std::string_view suffix) {
  const Cloud cloud = Good(bytes, suffix);
  EXPECT_EQ(cloud.points_m, kTwo);
  EXPECT_TRUE(cloud.fields.empty());
  EXPECT_EQ(cloud.dropped, 0u);
}

std::string WithCrLf(std::string text) {
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  return text;
}

std::string Without(std::string text, const std::string& line_start) {
  const std::size_t begin = text.find("\n" + line_start) + 1;
  return text.erase(begin, text.find('\n', begin) + 1 - begin);
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Pcd, Ascii) {
  const std::string text = XyzPcd(2) + "DATA ascii\n" + kTwoText;
  ExpectTwo(text, "pcd");
  ExpectTwo(WithCrLf(text), "pcd");
  ExpectTwo(text.substr(0, text.size() - 1), "pcd");
  ExpectTwo(XyzPcd(2) + "DATA ascii\n\n  1\t+2 3e0 \n\n-4.5 -0 6.25\n \n", "pcd");
}

TEST(Pcd, HeadersOfAllVersions) {
  const std::string body = "DATA ascii\n" + kTwoText;
  for (const char* version : {"0.7", ".7", "0.6", ".6", "0.5", ".5"})
    ExpectTwo(Replaced(XyzPcd(2), "VERSION 0.7", std::string("VERSION ") + version) + body, "pcd");
  for (const char* line : {"VERSION", "COUNT", "HEIGHT", "WIDTH", "POINTS", "VIEWPOINT"})
    ExpectTwo(Without(XyzPcd(2), line) + body, "pcd");
  ExpectTwo(Without(XyzPcd(2).substr(12), "VERSION") + body, "pcd");
  ExpectTwo("FIELDS x y z\nPOINTS 2\nTYPE F F F\nSIZE 4 4 4\n" + body, "pcd");
}

TEST(Pcd, Binary) {
  ExpectTwo(XyzPcd(2) + "DATA binary\n" + kTwoBytes, "pcd");
  ExpectTwo(WithCrLf(XyzPcd(2) + "DATA binary\n") + kTwoBytes, "pcd");
  ExpectTwo(XyzPcd(2) + "DATA binary\n" + kTwoBytes + "\n", "pcd");  // less than a point may follow
  ExpectTwo(XyzPcd(2) + "DATA binary\n" + kTwoBytes + std::string(4096, '\0'), "pcd");
}

TEST(Pcd, BinaryCompressedIsFieldByField) {
  const std::string plain = Floats(1, -4.5, 2, 0, 3, 6.25);
  ExpectTwo(XyzPcd(2) + "DATA binary_compressed\n" + CompressedBody(Packed(plain), plain.size()), "pcd");
}

TEST(Pcd, BinaryCompressedWithReferences) {
  // "00000000" is one literal byte and a reference of seven bytes, one byte back.
  const std::string packed = std::string("\x00\x00\xa0\x00", 4) + "\x03" + Little(1.0f);
  const Cloud cloud = Good(XyzPcd(1) + "DATA binary_compressed\n" + CompressedBody(packed, 12), "pcd");
  EXPECT_EQ(cloud.points_m, (Points{{0.0f, 0.0f, 1.0f}}));
}

TEST(Pcd, OrganisedCloudsAreLists) {
  std::string text = Replaced(XyzPcd(4) + "DATA ascii\n", "HEIGHT 1", "HEIGHT 2");
  text = Replaced(text, "WIDTH 4", "WIDTH 2");
  const Cloud cloud = Good(text + "1 0 0\nnan nan nan\n3 0 0\n4 0 0\n", "pcd");
  EXPECT_EQ(cloud.points_m, (Points{{1, 0, 0}, {3, 0, 0}, {4, 0, 0}}));
  EXPECT_EQ(cloud.dropped, 1u);
}

TEST(Pcd, TheViewpointMovesNothing) {
  ExpectTwo(Replaced(XyzPcd(2), "0 0 0 1 0 0 0", "10 20 30 0 1 0 0") + "DATA ascii\n" + kTwoText, "pcd");
}

struct TypeCase {
  const char *type, *size;
  std::string bytes;
  double value;
};

TEST(Pcd, EveryType) {
  const std::vector<TypeCase> cases = {{"I", "1", Little(std::int8_t{-100}), -100},
                                       {"I", "2", Little(std::int16_t{-30000}), -30000},
                                       {"I", "4", Little(std::int32_t{-2000000000}), -2e9},
                                       {"I", "8", Little(std::int64_t{-9000000000}), -9e9},
                                       {"U", "1", Little(std::uint8_t{200}), 200},
                                       {"U", "2", Little(std::uint16_t{60000}), 60000},
                                       {"U", "4", Little(std::uint32_t{4000000000}), 4e9},
                                       {"U", "8", Little(std::uint64_t{10000000000000000000u}), 1e19},
                                       {"F", "4", Little(-0.5f), -0.5},
                                       {"F", "8", Little(1e-300), 1e-300}};
  for (const TypeCase& c : cases) {
    // The field stands before x, so that x y z are not aligned.
    const std::string header =
        PcdHeaderOf("a x y z", std::string(c.size) + " 8 4 8", std::string(c.type) + " F F F", "1 1 1 1", 1);
    const std::string body = c.bytes + Little(1.5) + Little(2.5f) + Little(3.5);
    const std::string packed = CompressedBody(Packed(body), body.size());
    for (const std::string& bytes : {header + "DATA binary\n" + body, header + "DATA binary_compressed\n" + packed,
                                     header + "DATA ascii\n" + std::to_string(c.value * 1.0) + " 1.5 2.5 3.5\n"}) {
      const Cloud cloud = Good(bytes, "pcd");
      EXPECT_EQ(cloud.points_m, (Points{{1.5f, 2.5f, 3.5f}}));
      ASSERT_EQ(cloud.fields.size(), 1u);
      EXPECT_EQ(cloud.fields[0].name, "a");
      EXPECT_NEAR(cloud.fields[0].values.at(0), c.value, 1e-299) << c.type << c.size;
    }
  }
}

TEST(Pcd, FieldsOfSeveralValuesAndPadding) {
  const std::string header = PcdHeaderOf("_ x a y _ z", "1 4 2 4 1 4", "U F U F U F", "3 1 2 1 1 1", 2);
  const auto u2 = [](int value) { return Little(static_cast<std::uint16_t>(value)); };
  const std::string rows = "pad" + Floats(1) + u2(7) + u2(8) + Floats(2) + "p" + Floats(3) +  //
                           "pad" + Floats(4) + u2(9) + u2(10) + Floats(5) + "p" + Floats(6);
  const std::string plain =
      "padpad" + Floats(1, 4) + u2(7) + u2(8) + u2(9) + u2(10) + Floats(2, 5) + "pp" + Floats(3, 6);
  for (const std::string& bytes :
       {header + "DATA binary\n" + rows, header + "DATA ascii\n0 0 0 1 7 8 2 0 3\n0 0 0 4 9 10 5 0 6\n",
        header + "DATA binary_compressed\n" + CompressedBody(Packed(plain), plain.size())}) {
    const Cloud cloud = Good(bytes, "pcd");
    EXPECT_EQ(cloud.points_m, (Points{{1, 2, 3}, {4, 5, 6}}));
    ASSERT_EQ(cloud.fields.size(), 2u);
    EXPECT_EQ(cloud.fields[0].name, "a_0");
    EXPECT_EQ(cloud.fields[0].values, (std::vector<double>{7, 9}));
    EXPECT_EQ(cloud.fields[1].name, "a_1");
    EXPECT_EQ(cloud.fields[1].values, (std::vector<double>{8, 10}));
  }
}

TEST(Cloud, BeamsWithoutAReturnAreCounted) {
  const std::string bytes = Floats(1, 2, 3, 10) + Floats(kNan, 0, 0, 20) + Floats(0, kInf, 0, 30) +
                            Floats(0, 0, -kInf, 40) + Floats(1001, 0, 0, 50) + Floats(0, -1e30, 0, 60) +
                            Floats(0, 0, 1000, 70);
  const Cloud cloud = Good(bytes, "bin");
  EXPECT_EQ(cloud.points_m, (Points{{1, 2, 3}, {0, 0, 1000}}));
  EXPECT_EQ(cloud.dropped, 5u);
  EXPECT_EQ(cloud.beyond_1km, 2u);
  ASSERT_EQ(cloud.fields.size(), 1u);
  EXPECT_EQ(cloud.fields[0].name, "intensity");
  EXPECT_EQ(cloud.fields[0].values, (std::vector<double>{10, 70}));
}

TEST(Cloud, AFieldWithoutAFiniteValueAtAKeptPointIsLeftOutByName) {
  const std::string header = PcdHeaderOf("x y z a b c", "4 4 4 4 4 4", "F F F F F F", "1 1 1 1 1 1", 3);
  const Cloud cloud = Good(header + "DATA ascii\n1 1 1 5 nan 7\n2 2 2 6 8 -inf\nnan 0 0 NaN 9 9\n", "pcd");
  EXPECT_EQ(cloud.points_m.size(), 2u);
  ASSERT_EQ(cloud.fields.size(), 1u);
  EXPECT_EQ(cloud.fields[0].name, "a");
  EXPECT_EQ(cloud.fields[0].values, (std::vector<double>{5, 6}));
  EXPECT_EQ(cloud.left_out, (std::vector<std::string>{"b", "c"}));
}

TEST(Kitti, Reads) {
  const Cloud cloud = Good(Floats(1, 2, 3, 0.25, -4.5, 0, 6.25, 0.75), "bin");
  EXPECT_EQ(cloud.points_m, kTwo);
  EXPECT_EQ(cloud.fields.at(0).values, (std::vector<double>{0.25, 0.75}));
}

TEST(Ply, Variants) {
  std::string big;
  for (const float value : {1.0f, 2.0f, 3.0f, -4.5f, 0.0f, 6.25f}) big += Big(value);
  ExpectTwo(PlyHeaderOf("ascii", XyzElement(2)) + kTwoText, "ply");
  ExpectTwo(WithCrLf(PlyHeaderOf("ascii", XyzElement(2)) + kTwoText), "ply");
  ExpectTwo(PlyHeaderOf("binary_little_endian", XyzElement(2)) + kTwoBytes, "ply");
  ExpectTwo(WithCrLf(PlyHeaderOf("binary_little_endian", XyzElement(2))) + kTwoBytes, "ply");
  ExpectTwo(PlyHeaderOf("binary_big_endian", XyzElement(2)) + big, "ply");
}

TEST(Ply, EveryType) {
  struct Type {
    std::string names, big, little;
    double value;
  };
  const std::vector<Type> types = {
      {"char int8", Big(std::int8_t{-5}), Little(std::int8_t{-5}), -5},
      {"uchar uint8", Big(std::uint8_t{250}), Little(std::uint8_t{250}), 250},
      {"short int16", Big(std::int16_t{-300}), Little(std::int16_t{-300}), -300},
      {"ushort uint16", Big(std::uint16_t{65000}), Little(std::uint16_t{65000}), 65000},
      {"int int32", Big(std::int32_t{-70000}), Little(std::int32_t{-70000}), -70000},
      {"uint uint32", Big(std::uint32_t{3000000000}), Little(std::uint32_t{3000000000}), 3e9},
      {"float float32", Big(0.5f), Little(0.5f), 0.5},
      {"double float64", Big(-1e200), Little(-1e200), -1e200}};
  for (const Type& type : types) {
    const std::size_t space = type.names.find(' ');
    for (const std::string& name : {type.names.substr(0, space), type.names.substr(space + 1)}) {
      const std::string element =
          "element vertex 1\nproperty " + name + " a\nproperty float64 x\nproperty float32 y\nproperty double z\n";
      const Cloud big =
          Good(PlyHeaderOf("binary_big_endian", element) + type.big + Big(1.5) + Big(2.5f) + Big(3.5), "ply");
      const Cloud little = Good(
          PlyHeaderOf("binary_little_endian", element) + type.little + Little(1.5) + Little(2.5f) + Little(3.5), "ply");
      for (const Cloud& cloud : {big, little}) {
        EXPECT_EQ(cloud.points_m, (Points{{1.5f, 2.5f, 3.5f}})) << name;
        ASSERT_EQ(cloud.fields.size(), 1u) << name;
        EXPECT_EQ(cloud.fields[0].values, (std::vector<double>{type.value})) << name;
      }
    }
  }
}

TEST(Ply, OtherElementsAreStepped) {
  const std::string before = "element camera 2\nproperty uchar a\nproperty double b\nelement nothing 5\n";
  const std::string after = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string elements = before + XyzElement(2) + after;
  ExpectTwo(PlyHeaderOf("binary_little_endian", elements) + std::string(18, 'c') + kTwoBytes + "whatever follows",
            "ply");
  ExpectTwo(PlyHeaderOf("ascii", elements) + "7 8\n9 10\n" + kTwoText + "3 0 1 1\n", "ply");
}

CloudSize ClaimOf(const std::string& bytes, std::string_view suffix, std::size_t start_bytes) {
  return ClaimedSize(std::as_bytes(std::span(bytes.data(), start_bytes)), suffix, bytes.size());
}

TEST(ClaimedSize, ComesFromTheHeaderAlone) {
  const std::string pcd = XyzPcd(1234) + "DATA binary\n",
                    ply = PlyHeaderOf("ascii", "element face 3\nproperty int a\n" + XyzElement(99));
  for (const auto& [bytes, suffix, points] : {std::tuple(pcd, "pcd", 1234u), {ply, "ply", 99u}}) {
    EXPECT_EQ(ClaimOf(bytes, suffix, bytes.size()).points, points);
    EXPECT_EQ(ClaimOf(bytes, suffix, bytes.size()).values, 3 * points);
    EXPECT_EQ(ClaimOf(bytes, suffix, 20).points, 0u);  // the header is cut off
  }
  EXPECT_EQ(ClaimOf(std::string(160, 'x'), "bin", 0).points, 13u);  // of three numbers each
  EXPECT_EQ(ClaimOf(std::string(160, 'x'), "bin", 0).values, 52u);
  EXPECT_EQ(ClaimOf(pcd, "txt", pcd.size()).points, 0u);
}

TEST(ClaimedSize, IsAtMostWhatIsAdmitted) {
  const std::string pcd = XyzPcd(2'000'000'000) + "DATA binary\n";
  EXPECT_EQ(ClaimOf(pcd, "pcd", pcd.size()).points, limits::kCloudPointsMax);
  EXPECT_LE(ClaimOf(pcd, "pcd", pcd.size()).values, limits::kCloudValuesMax);
}

}  // namespace
}  // namespace rigcal::formats

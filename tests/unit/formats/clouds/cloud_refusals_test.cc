#include "server/base/limits.h"
#include "tests/unit/formats/clouds/cloud_samples.h"

namespace rigcal::formats {
namespace {

struct BadCase {
  std::string title, suffix, bytes, what;  // `what`: a part of the error
};
void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.title; }

std::string Pcd(const std::string& from, const std::string& with, const std::string& body = "DATA ascii\n1 2 3\n") {
  std::string text = XyzPcd(1) + body;
  return text.replace(text.find(from), from.size(), with);
}
std::string Points(const std::string& number, const std::string& data) {
  return "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS " + number + "\nDATA " + data + "\n" + Floats(1, 2, 3);
}
std::string Compressed(const std::string& body) { return XyzPcd(1) + "DATA binary_compressed\n" + body; }
std::string Fields(const std::string& names, const std::string& entries) {
  std::string sizes, types;
  for (char c : entries) sizes += " 4", types += std::string(" ") + c;
  return "FIELDS " + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nPOINTS 1\nDATA ascii\n1 2 3 4 5\n";
}
std::string Ply(const std::string& elements, const std::string& body = "1 2 3\n", const std::string& format = "ascii") {
  return PlyHeaderOf(format, elements) + body;
}
std::string Vertex(const std::string& count) {
  return "element vertex " + count + "\nproperty float x\nproperty float y\nproperty float z\n";
}

const std::string kPlain = Floats(1, 2, 3);

std::vector<BadCase> PcdHeaders() {
  return {{"empty", "pcd", "", "is empty"},
          {"only zeros", "pcd", std::string(100, '\0'), "is no key"},
          {"no DATA line", "pcd", XyzPcd(1), "no DATA line"},
          {"endless comments", "pcd", std::string(200'000, '#') + "\nDATA ascii\n", "no DATA line in its first 65536"},
          {"endless header", "pcd", XyzPcd(1) + std::string(70'000, '\n') + "DATA ascii\n1 2 3\n", "no DATA line"},
          {"unknown key", "pcd", Pcd("HEIGHT", "DEPTH"), "\"DEPTH\" is no key"},
          {"key twice", "pcd", Pcd("HEIGHT", "WIDTH"), "line 8: WIDTH occurs twice"},
          {"version of the future", "pcd", Pcd("VERSION 0.7", "VERSION 9.9"), "VERSION \"9.9\""},
          {"version without a number", "pcd", Pcd("VERSION 0.7", "VERSION"), "VERSION \"\""},
          {"no FIELDS", "pcd", Pcd("FIELDS x y z", "#"), "no FIELDS line"},
          {"no SIZE", "pcd", Pcd("SIZE 4 4 4", "#"), "no SIZE line"},
          {"no TYPE", "pcd", Pcd("TYPE F F F", "#"), "no TYPE line"},
          {"fewer sizes than fields", "pcd", Pcd("SIZE 4 4 4", "SIZE 4 4"), "SIZE has 2 entries for 3 fields"},
          {"more counts than fields", "pcd", Pcd("COUNT 1 1 1", "COUNT 1 1 1 1"), "COUNT has 4 entries"},
          {"SIZE 3", "pcd", Pcd("SIZE 4", "SIZE 3"), "SIZE \"3\""},
          {"SIZE -4", "pcd", Pcd("SIZE 4", "SIZE -4"), "SIZE \"-4\""},
          {"TYPE X", "pcd", Pcd("TYPE F", "TYPE X"), "TYPE \"X\""},
          {"half floats", "pcd", Pcd("SIZE 4", "SIZE 2"), "TYPE \"F\" and SIZE \"2\""},
          {"COUNT 0", "pcd", Pcd("COUNT 1", "COUNT 0"), "COUNT \"0\""},
          {"COUNT 1e18", "pcd", Pcd("COUNT 1", "COUNT 1000000000000000000"), "COUNT \"1000000000000000000\""},
          {"integer coordinates", "pcd", Pcd("TYPE F F F", "TYPE F I F"), "field \"y\" is an integer"},
          {"x is missing", "pcd", Fields("a y z", "FFF"), "field \"x\" is missing"},
          {"x of two values", "pcd", Pcd("COUNT 1", "COUNT 2"), "field \"x\" is missing"},
          {"no fields at all", "pcd", "FIELDS\nSIZE\nTYPE\nPOINTS 1\nDATA ascii\n", "field \"x\" is missing"},
          {"a field twice", "pcd", Fields("x y z a a", "FFFFF"), "field \"a\" occurs twice"},
          {"a field that breaks the terminal", "pcd", Fields("x y z \x1b[2J", "FFFF"), "\"\\x1b[2J\""},
          {"a field of 10000 characters", "pcd", Fields("x y z " + std::string(10'000, 'f'), "FFFF"), "too long"},
          {"unknown DATA", "pcd", Pcd("DATA ascii", "DATA zip"), "DATA \"zip\""},
          {"DATA without a word", "pcd", Pcd("DATA ascii", "DATA"), "DATA \"\""}};
}

std::vector<BadCase> PcdCounts() {
  return {
      {"8e9 points", "pcd", Points("8000000000", "binary"), "announces 8000000000 points"},
      {"8e9 points, compressed", "pcd", Points("8000000000", "binary_compressed"), "announces 8000000000 points"},
      {"8e9 points, text", "pcd", Points("8000000000", "ascii"), "announces 8000000000 points"},
      {"a point more than there is", "pcd", Points("2", "binary"), "2 points of 12 bytes, but 12 bytes follow"},
      {"5 million points in 12 bytes", "pcd", Points("5000000", "binary"), "5000000 points of 12 bytes"},
      {"5 million points in text", "pcd", Points("5000000", "ascii"), "cannot hold them"},
      {"negative", "pcd", Points("-1", "ascii"), "POINTS \"-1\" is not a count"},
      {"beyond 64 bit", "pcd", Points("99999999999999999999", "ascii"), "is not a count"},
      {"a fraction", "pcd", Points("1.5", "ascii"), "POINTS \"1.5\""},
      {"two numbers", "pcd", Points("1 1", "ascii"), "is not a count"},
      {"no points", "pcd", Points("0", "ascii"), "follows the last of the 0 points"},
      {"no points and nothing else", "pcd", XyzPcd(0) + "DATA binary\n", "no point with finite coordinates"},
      {"neither WIDTH nor POINTS", "pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nHEIGHT 1\nDATA ascii\n1 2 3\n",
       "neither WIDTH"},
      {"POINTS are not WIDTH x HEIGHT", "pcd", Pcd("HEIGHT 1", "HEIGHT 2"), "POINTS 1 is not WIDTH times HEIGHT, 2"},
      {"WIDTH x HEIGHT overflows to 1", "pcd", Pcd("WIDTH 1\nHEIGHT 1", "WIDTH 12297829382473034411\nHEIGHT 3"),
       "HEIGHT 3 is no count"},
      {"WIDTH x HEIGHT overflows", "pcd", Pcd("WIDTH 1\nHEIGHT 1", "WIDTH 4294967296\nHEIGHT 4294967297"),
       "WIDTH 4294967296 times HEIGHT 4294967297 is no count"}};
}

std::vector<BadCase> PcdBodies() {
  return {
      {"half a point", "pcd", XyzPcd(1) + "DATA binary\n" + kPlain.substr(0, 11), "1 points of 12 bytes, but 11 bytes"},
      {"a point too many", "pcd", XyzPcd(1) + "DATA binary\n" + kPlain + kPlain, "24 bytes follow"},
      {"a word that is no number", "pcd", XyzPcd(1) + "DATA ascii\n1 two 3\n", "line 12: \"two\" is not a number"},
      {"decimal comma", "pcd", XyzPcd(1) + "DATA ascii\n1,5 2 3\n", "\"1,5\" is not a number"},
      {"hexadecimal", "pcd", XyzPcd(1) + "DATA ascii\n0x10 2 3\n", "\"0x10\""},
      {"beyond double", "pcd", XyzPcd(1) + "DATA ascii\n1e999 2 3\n", "\"1e999\""},
      {"too few numbers", "pcd", XyzPcd(2) + "DATA ascii\n1 2\n3 4 5 6 7\n", "line 12: has 2 of 3 numbers"},
      {"too many numbers", "pcd", XyzPcd(1) + "DATA ascii\n1 2 3 4\n", "line 12: has more than 3 numbers"},
      {"ends early", "pcd", XyzPcd(2) + "DATA ascii\n1.000 2.000 3.000\n", "ends after 1 of 2 points"},
      {"goes on", "pcd", XyzPcd(1) + "DATA ascii\n1 2 3\n4 5 6\n", "line 13: follows the last of the 1 points"},
      {"no finite point", "pcd", XyzPcd(1) + "DATA ascii\nnan nan nan\n", "no point with finite coordinates"},
      {"no compressed body", "pcd", Compressed("abc"), "before the sizes"},
      {"compressed body is cut off", "pcd", Compressed(CompressedBody(Packed(kPlain), 12).substr(0, 15)),
       "has 7 of 13 bytes"},
      {"compressed size lies", "pcd", Compressed(Little(0xffffffffu) + Little(12u) + Packed(kPlain)),
       "has 13 of 4294967295 bytes"},
      {"plain size lies", "pcd", Compressed(Little(13u) + Little(0xffffffffu) + Packed(kPlain)),
       "claims to hold 4294967295"},
      {"plain size zero", "pcd", Compressed(Little(13u) + Little(0u) + Packed(kPlain)), "claims to hold 0 bytes"},
      {"nothing unpacks to everything", "pcd",
       XyzPcd(1'000'000) + "DATA binary_compressed\n" + CompressedBody("abc", 12'000'000),
       "3 compressed bytes cannot hold 12000000"},
      {"LZF that refers to before its start", "pcd", Compressed(CompressedBody("\xe0\xff\xff\xff", 12)),
       "cannot be unpacked"},
      {"LZF that ends too early", "pcd", Compressed(CompressedBody(Packed(kPlain.substr(0, 8)), 12)),
       "cannot be unpacked"},
      {"LZF that goes on", "pcd", Compressed(CompressedBody(Packed(kPlain + kPlain), 12)), "cannot be unpacked"}};
}

std::vector<BadCase> Plys() {
  const std::string xyz = Vertex("1");
  std::vector<BadCase> cases = {
      {"ply: empty", "ply", "", "is empty"},
      {"ply: a PCD", "ply", XyzPcd(1), "does not begin with the line \"ply\""},
      {"ply: no end_header", "ply", "ply\nformat ascii 1.0\n" + xyz, "no end_header line"},
      {"ply: end_header beyond 64 KiB", "ply", Ply(std::string(70'000, '\n') + xyz), "in its first 65536 bytes"},
      {"ply: no format", "ply", "ply\n" + xyz + "end_header\n1 2 3\n", "no format line"},
      {"ply: two formats", "ply", Ply("format ascii 1.0\n" + xyz), "a second format line"},
      {"ply: version 2", "ply", "ply\nformat ascii 2.0\nend_header\n", "version 1.0"},
      {"ply: unknown format", "ply", Ply(xyz, "", "binary_pdp_endian"), "\"binary_pdp_endian\""},
      {"ply: unknown keyword", "ply", Ply("elephant 1\n" + xyz), "\"elephant\" is no keyword"},
      {"ply: element without a count", "ply", Ply("element vertex\n"), "a name and a count"},
      {"ply: element count negative", "ply", Ply(Vertex("-1")), "\"-1\" is not a count"},
      {"ply: element twice", "ply", Ply(xyz + xyz), "element \"vertex\" occurs twice"},
      {"ply: no vertex", "ply", Ply("element point 1\nproperty float x\n"), "no element \"vertex\""},
      {"ply: property without element", "ply", Ply("property float x\n"), "before the first element"},
      {"ply: property without a name", "ply", Ply("element vertex 1\nproperty float\n"), "a type and a name"},
      {"ply: unknown type", "ply", Ply("element vertex 1\nproperty quad x\n"), "unknown type \"quad\""},
      {"ply: vertex with a list", "ply", Ply(xyz + "property list uchar float echoes\n"),
       "\"echoes\" of element \"vertex\" is a list"},
      {"ply: a list before vertex", "ply", Ply("element face 1\nproperty list uchar int corners\n" + xyz),
       "\"corners\" of element \"face\" is a list"},
      {"ply: y is missing", "ply", Ply("element vertex 1\nproperty float x\nproperty float z\n"),
       "field \"y\" is missing"},
      {"ply: vertex without properties", "ply", Ply("element vertex 9\n"), "field \"x\" is missing"},
      {"ply: integer coordinates", "ply", Ply("element vertex 1\nproperty int x\nproperty float y\nproperty float z\n"),
       "is an integer"},
      {"ply: a property twice", "ply", Ply(xyz + "property float x\n"), "field \"x\" occurs twice"},
      {"ply: other element cut off", "ply",
       Ply("element a 9000000000\nproperty int b\n" + xyz, "1 2 3\n", "binary_big_endian"),
       "ends within the 9000000000 of element \"a\""},
      {"ply: other element's lines cut off", "ply", Ply("element a 9000000000\nproperty int b\n" + xyz), "ends within"},
      {"ply: text cut off", "ply", Ply(Vertex("2")), "cannot hold them"},
      {"ply: text goes on", "ply", Ply(xyz, "1 2 3\n4 5 6\n"), "line 10: follows the last"}};
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    cases.push_back({std::string("ply: 8e9 points, ") + format, "ply", Ply(Vertex("8000000000"), kPlain, format),
                     "announces 8000000000 points"});
    cases.push_back(
        {std::string("ply: 5e6 points, ") + format, "ply", Ply(Vertex("5000000"), kPlain, format), "5000000 points"});
    cases.push_back(
        {std::string("ply: no points, ") + format, "ply", Ply(Vertex("0"), "", format), "no point with finite"});
  }
  return cases;
}

std::vector<BadCase> Others() {
  const std::string wide = [] {
    std::string header = "element vertex 1\n";
    for (std::size_t i = 0; i <= limits::kCloudFieldsMax; ++i) header += "property uchar f" + std::to_string(i) + "\n";
    return header;
  }();
  return {{"bin: empty", "bin", "", "is empty"},
          {"bin: 15 bytes", "bin", std::string(15, 'x'), "has 15 bytes, which is no multiple of 16"},
          {"bin: three floats per point", "bin", kPlain, "no multiple of 16"},
          {"bin: no finite point", "bin", std::string(32, '\xff'), "no point with finite coordinates"},
          {"unknown suffix", "las", "LASF", "suffix \"las\""},
          {"ply: too many properties", "ply", Ply(wide), "more than 512 values"},
          {"pcd: too many values", "pcd", Pcd("COUNT 1 1 1", "COUNT 513 1 1"), "more than 512 values"},
          {"pcd: points times values", "pcd",
           "FIELDS x y z a\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 100\nPOINTS 4900000\nDATA ascii\n",
           "announces 504700000 values"}};
}

std::vector<BadCase> AllBadCases() {
  std::vector<BadCase> all;
  for (auto make : {PcdHeaders, PcdCounts, PcdBodies, Plys, Others})
    for (BadCase& bad : make()) all.push_back(std::move(bad));
  return all;
}

class BadCloud : public testing::TestWithParam<BadCase> {};

TEST_P(BadCloud, IsRefusedInOneSentenceWithACure) {
  const BadCase& bad = GetParam();
  const auto cloud = ReadText(bad.bytes, bad.suffix);
  ASSERT_FALSE(cloud);
  const Error& error = cloud.error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(error.what.rfind("file \"top/01." + bad.suffix + "\": ", 0), 0u) << error.what;
  EXPECT_NE(error.what.find(bad.what), std::string::npos) << error.what;
  EXPECT_FALSE(error.cure.empty());
  EXPECT_LT(error.what.size(), 400u);
  for (const char c : error.what) EXPECT_TRUE(c >= ' ' && c < 127) << error.what;
}

INSTANTIATE_TEST_SUITE_P(Table, BadCloud, testing::ValuesIn(AllBadCases()));

TEST(BadClouds, TheCureOfABinNamesWhatToGive) {
  EXPECT_NE(ReadText("x", "bin").error().cure.find("fields and point_type of sensor 'top'"), std::string::npos);
}

// Every beginning of a good file is refused or read, never more.
TEST(BadClouds, EveryBeginning) {
  const std::string plain = Floats(1, 4, 2, 5, 3, 6);
  const std::vector<std::pair<std::string, std::string>> files = {
      {"pcd", XyzPcd(2) + "DATA ascii\n1.25 2.25 3.25\n4.25 5.25 6.25\n"},
      {"pcd", XyzPcd(2) + "DATA binary\n" + plain},
      {"pcd", XyzPcd(2) + "DATA binary_compressed\n" + CompressedBody(Packed(plain), plain.size())},
      {"ply", Ply(Vertex("2"), plain, "binary_big_endian")},
      {"ply", Ply(Vertex("2"), "1 2 3\n4 5 6\n")}};
  for (const auto& [suffix, bytes] : files) {
    ASSERT_TRUE(ReadText(bytes, suffix));
    for (std::size_t size = 0; size + 6 < bytes.size(); ++size)
      EXPECT_FALSE(ReadText(bytes.substr(0, size), suffix)) << suffix << " " << size;
  }
}

}  // namespace
}  // namespace rigcal::formats

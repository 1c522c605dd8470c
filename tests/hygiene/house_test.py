"""How `deploy/measure house` reads the sources: on small samples whose answer is known."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "deploy"))
import include_table_test as table  # noqa: E402
from measures.sources import include_graph, same_tokens  # noqa: E402
from measures.sources.cpp_outline import Outline, comment_lines  # noqa: E402

CLASS = """namespace a {
class B : public C<int(double)> {
  int hidden_first_ = 0;
  void HiddenFirst();
 public:
  explicit B(int a = {}, std::function<void(int)> b = nullptr) : x_{a}, y_(a) { F("}"); }
  B(const B&) = delete;
  ~B();
  [[nodiscard]] std::map<int, std::vector<int>> Of(const std::string& name, int (*f)(int) = g(1, 2)) const;
  bool operator()(int a) const { return a < 2; }
  static int Count();
  friend bool operator==(const B&, const B&) = default;
  using Row = std::vector<int>;
  enum class State { kOne, kTwo };
  struct Inner {
    int one, two = 2;
  };
  void Run() override;

 private:
  void Hidden();
  static constexpr int kMany = 3;
  std::function<void(int)> f_;
  int x_ = {3}, *y_ = nullptr;
  std::vector<std::pair<int, double>> rows_ = {{1, 2.0}, {3, 4.0}};
};
}
"""

CONTRACTS = """// What the file is for.

// Above.
int One(int a,
        int b);
int Two();
int Three();  // beside
              // and goes on
int Four();

int Five();
struct S {
  int Six() const;  // beside
  // Above.
  int Seven();

  // Of a member.
  int member = 0;
  int Eight() const { return member; }
  S() = default;
};
inline int Nine() { return 9; }  // beside
inline int Ten() {
  return 10;  // why
}
namespace detail {
int Eleven();
}
// Above a template.
template <typename T>
T Twelve(T t = {});
inline int S::Thirteen() { return 1; }
inline constexpr int kFourteen = Five(14);
"""


class Classes(unittest.TestCase):
    def test_methods_and_members(self):
        classes = {one.name: one for one in Outline(CLASS).classes}
        self.assertEqual({"B", "Inner"}, set(classes))
        self.assertEqual(["HiddenFirst", "B", "~B", "Of", "operator_", "Count", "Run", "Hidden"], classes["B"].methods)
        self.assertEqual(["hidden_first_", "f_", "x_", "y_", "rows_"], classes["B"].members)
        self.assertEqual(["one", "two"], classes["Inner"].members)

    def test_public_prototypes(self):
        self.assertEqual(["B::B", "B::Of", "B::operator_", "B::Count"], [one.name for one in Outline(CLASS).prototypes])


class Contracts(unittest.TestCase):
    def test_where_one_stands(self):
        covered = {one.name: one.covered for one in Outline(CONTRACTS).prototypes}
        self.assertEqual({"One": True, "Two": True, "Three": True, "Four": False, "Five": False, "S::Six": True, "S::Seven": True,
                          "S::Eight": False, "Nine": True, "Ten": False, "Twelve": True}, covered)

    def test_lines_of_comments(self):
        self.assertEqual(({1, 4}, {2}), comment_lines('// a\nint b;  // c "\nconst char* d = "// e";\n/* f */\n'))


class Repetition(unittest.TestCase):
    BODY = "int %s(int %s) { for (int i = 0; i < %s; ++i) { sum += %s * i; } return sum; }\n"

    def pairs(self, *texts):
        return same_tokens.same_stretches([same_tokens.tokens(text) for text in texts], 30)

    def test_other_names_are_the_same(self):
        self.assertEqual([((0, 1), (1, 2))], self.pairs(self.BODY % ("F", "a", "a", "a"), "\n" + self.BODY % ("G", "b", "b", "b")))

    def test_names_that_are_mixed_up_are_not(self):
        self.assertEqual([], self.pairs(self.BODY % ("F", "a", "a", "a"), self.BODY % ("G", "b", "b", "c")))

    def test_a_row_of_values_does_not_repeat_itself_by_overlap(self):
        self.assertEqual([], self.pairs("int a[] = {" + "1, " * 20 + "};"))


class Includes(unittest.TestCase):
    ROWS = table.parse_table("| module | base | graph | libraries |\n|---|---|---|---|\n| server/base | | x | - |\n| server/graph | x | | - |\n"
                             "| server/main.cc | everything | | |\n")

    def test_cycles(self):
        texts = {"server/base/a.h": '#include "server/base/b.h"\n', "server/base/b.h": '#include "server/base/c.h"\n',
                 "server/base/c.h": '#include "server/base/b.h"\n', "server/base/d.h": '#include "server/base/a.h"\n'}
        self.assertEqual([("server/base/b.h", "server/base/c.h")], include_graph.cycles(include_graph.includes(texts)))
        self.assertEqual([], include_graph.cycles(include_graph.between(include_graph.includes(texts), lambda path: "server/base")))

    def test_upward(self):
        texts = {"server/base/a.h": '#include "server/graph/b.h"\n', "server/graph/b.h": '#include "server/base/c.h"\n', "server/base/c.h": "",
                 "server/main.cc": '#include "server/graph/b.h"\n'}
        self.assertEqual(["server/base/a.h: server/graph/b.h is of a later row"], include_graph.upward(texts, self.ROWS))


if __name__ == "__main__":
    unittest.main()

"""No function over 60 lines, no file over 400."""
import re
import unittest

import sources

FUNCTION_LINES_MAX = 60
FILE_LINES_MAX = 400
FILE_SUFFIXES = {".cc", ".h", ".inc", ".py", ".js", ".css", ".tpl", ".html", ".sql", ".idl", ".sh", ".cmake"}
SCOPE = re.compile(r'\bnamespace\b|\bextern\s*$|(?:^|\s)(?:class|struct|union|enum)\b(?![^{]*\))')


def is_scope(head):
    """Whether `head {` opens a namespace, a class or an enumeration."""
    return SCOPE.search(re.sub(r"<[^<>]*>", " ", head)) is not None


def is_function(head):
    outside = re.sub(r"\([^()]*\)", "()", re.sub(r"operator\s*[=!<>]=?", "operator", head))
    return "()" in outside and not re.search(r"(?<![=!<>])=(?!=)", outside.split("()")[0])


def matching_brace(code, start):
    depth = 0
    for at in range(start, len(code)):
        depth += {"{": 1, "}": -1}.get(code[at], 0)
        if depth == 0:
            return at
    return len(code) - 1


def ends_declaration(code, after):
    """A brace pair of a member initializer is followed by ',' or the body's '{'; of a variable by ';'."""
    rest = code[after:].lstrip()
    return not rest or rest[0] not in ",{;)"


def without_directives(code):
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: re.sub(r"[^\n]", " ", m.group(0)), code, flags=re.MULTILINE)


def functions(text):
    """(first line, last line) of every function body's declaration in C++ text."""
    code = without_directives(sources.code_of(text))
    found, start, at = [], 0, 0
    while at < len(code):
        if code[at] in ";}":
            start = at + 1
        elif code[at] == "{" and is_scope(code[start:at]):
            start = at + 1
        elif code[at] == "{":
            head, at = code[start:at], matching_brace(code, at)
            if ends_declaration(code, at + 1):
                found += span(code, start, at) if is_function(head) else []
                start = at + 1
        elif code[at] == ":" and re.search(r"\b(public|private|protected)\s*$", code[start:at]):
            start = at + 1
        at += 1
    return found


def span(code, start, end):
    first = start + len(code[start:]) - len(code[start:].lstrip())
    return [(code.count("\n", 0, first) + 1, code.count("\n", 0, end) + 1)]


class TheProject(unittest.TestCase):
    def test_functions_are_short(self):
        long, count = [], 0
        for path in sources.tracked():
            if path.suffix not in (".cc", ".h", ".inc"):
                continue
            for first, last in functions(sources.read(path)):
                count += 1
                if last - first + 1 > FUNCTION_LINES_MAX:
                    long.append(f"{path}:{first}: {last - first + 1} lines")
        self.assertGreater(count, 100, "the sources were not found")
        self.assertEqual([], long)

    def test_files_are_short(self):
        long = []
        for path in sources.tracked():
            lines = sources.read(path).count("\n") if path.suffix in FILE_SUFFIXES else 0
            if lines > FILE_LINES_MAX:
                long.append(f"{path}: {lines} lines")
        self.assertEqual([], long)


class TheCheck(unittest.TestCase):
    def test_finds_functions(self):
        text = """namespace a {
class B : public C {
 public:
  B() : x_{1},
        y_(2) {
    f();
  }
  int x_ = {3};
};
template <typename T, class U>
bool operator==(const T& a, const U& b = {}) {
  if (a) { return "}{"; }  // }
  return '{' == R"x(}}})x"[0];
}
const int kTable[] = {
  1'000, 2 };
#define OPEN {
enum class E { kOne };
auto F() -> std::vector<int> { return {1, 2}; }
}
"""
        self.assertEqual([(4, 7), (10, 14), (19, 19)], functions(text))

    def test_measures_long_ones(self):
        text = "namespace {\nvoid F() {\n" + "  g();\n" * 70 + "}\n}\nvoid H(struct S s) {\n}\n"
        self.assertEqual([(2, 73), (75, 76)], functions(text))


if __name__ == "__main__":
    unittest.main()

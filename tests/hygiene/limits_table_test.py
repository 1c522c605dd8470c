"""docs/limits.md against the sources: every limit of limits.h with its default, and the range of those that may be set."""
import re
import unittest

import sources

PAGE, DEFAULTS, SETTINGS = "docs/limits.md", "server/base/limits.h", "server/base/limits_in_force.cc"
STRUCT = "server/base/limits_in_force.h"
LIMIT = re.compile(r"constexpr\s+[\w:]+\s+(k\w+)\s*=\s*([^;{]+);")
SETTING = re.compile(r'Setting\{"(\w+)",\s*&Limits::(\w+),\s*([^,]+),\s*([^}]+)\}')
MEMBER = re.compile(r"std::int64_t\s+(\w+)\s*=\s*(k\w+);")
UNITS = {"": 1, " KiB": 1 << 10, " MiB": 1 << 20, " GiB": 1 << 30}


def value_of(expression, known):
    """The value of a C++ constant expression of integers, shifts, products and earlier constants."""
    plain = re.sub(r"(?<=\d)(?:'(?=\d)|[uUlL]+)", "", expression).strip()
    return eval(plain, {"__builtins__": {}}, dict(known))


def limits_of(text):
    known = {}
    for name, expression in LIMIT.findall(text):
        known[name] = value_of(expression, known)
    return known


def settings_of(text, limits):
    """name: (least, ceiling)"""
    known = {**limits, **{name: value_of(expression, limits) for name, expression in LIMIT.findall(text)}}
    return {name: (value_of(least, known), value_of(most, known)) for name, _, least, most in SETTING.findall(text)}


def number_of(cell):
    """'2 GiB' or '100,000'."""
    match = re.fullmatch(r"([\d,]+)( [KMG]iB)?", cell.strip())
    return int(match.group(1).replace(",", "")) * UNITS[match.group(2) or ""]


def rows_of(text):
    """constant: (default, setting or '', range or None)"""
    rows = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) == 5 and re.fullmatch(r"`k\w+`", cells[0]):
            least, _, ceiling = cells[3].partition(" to ")
            bounds = (number_of(least), number_of(ceiling)) if ceiling else None
            rows[cells[0].strip("`")] = (number_of(cells[1]), cells[2].strip("`-"), bounds)
    return rows


class TheProject(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.limits = limits_of(sources.read(DEFAULTS))
        cls.settings = settings_of(sources.read(SETTINGS), cls.limits)
        cls.members = dict(MEMBER.findall(sources.read(STRUCT)))
        cls.rows = rows_of(sources.read(PAGE))

    def test_the_page_names_what_the_header_names(self):
        self.assertGreater(len(self.limits), 15)
        self.assertEqual(self.limits, {name: row[0] for name, row in self.rows.items()})

    def test_the_page_names_what_may_be_set(self):
        self.assertGreater(len(self.settings), 5)
        self.assertEqual(self.settings, {row[1]: row[2] for row in self.rows.values() if row[1]})

    def test_a_setting_is_its_own_member_and_default(self):
        self.assertEqual(set(self.settings), set(self.members))
        for name, member, *_ in SETTING.findall(sources.read(SETTINGS)):
            self.assertEqual(name, member)
        self.assertEqual(self.members, {row[1]: name for name, row in self.rows.items() if row[1]})


class TheCheck(unittest.TestCase):
    def test_reads_constants(self):
        self.assertEqual({"kA": 2 << 30, "kB": 100000, "kC": 3 * 100000},
                         limits_of("constexpr std::int64_t kA = 2LL << 30;  // x\nconstexpr std::size_t kB = 100'000;\n"
                                   "constexpr std::size_t kC = 3 * kB;"))

    def test_reads_settings_and_rows(self):
        self.assertEqual({"a": (2, 4 << 20)}, settings_of(
            'constexpr std::int64_t kM = 1 << 20;\n Setting{"a", &Limits::a, 2, 4 * kM},', {}))
        self.assertEqual({"kA": (64 << 20, "a", (1, 2 << 30)), "kB": (1000, "", None)}, rows_of(
            "| `kA` | 64 MiB | `a` | 1 to 2 GiB | x |\n| `kB` | 1,000 | - | - | y |\n| name | b | c | d | e |"))


if __name__ == "__main__":
    unittest.main()

"""Who may include whom: every #include line against the table of docs/includes.md."""
import re
import unittest

import sources

TABLE = "docs/includes.md"
FOLDERS = {"base", "metrics", "math", "model", "formats", "detect", "calib", "graph", "fleet", "cloud", "report", "http"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)
IDL_GENERATED = {"rigcal.h", "ros2.h"}
POSIX = re.compile(r"(sys|net|netinet|arpa)/\w+\.h|linux/(sched/\w+|tcp|openat2)\.h|(unistd|fcntl|signal|ifaddrs|poll|termios|netdb|pthread|spawn|dlfcn|malloc|pwd|time|stddef|stdint)\.h")
LIBRARIES = [
    ("tl/expected.hpp", "expected"), ("Eigen/", "Eigen"), ("unsupported/Eigen/", "Eigen"), ("openssl/", "OpenSSL"),
    ("spdlog/", "spdlog"), ("prometheus/", "Prometheus"), ("fmt/", "spdlog"), ("tbb/", "TBB"), ("oneapi/tbb/", "TBB"), ("boost/math/", "Boost.Math"),
    ("nlohmann/", "nlohmann-json"), ("yaml-cpp/", "yaml-cpp"), ("lzf.h", "LZF"), ("pugixml.hpp", "XML"), ("pcl/", "PCL"), ("SQLiteCpp/", "SQLiteCpp"),
    ("sqlite3.h", "SQLite"), ("opencv2/", "OpenCV"), ("ceres/", "Ceres"), ("glog/", "Ceres"), ("cholmod.h", "CHOLMOD"),
    ("ctemplate/", "ctemplate"), ("zip.h", "libzip"), ("cairo/", "cairo"), ("libpq-fe.h", "libpq"), ("zstd.h", "zstd"), ("lz4frame.h", "lz4"), ("bzlib.h", "bzip2"), ("zlib.h", "zlib"), ("curl/", "libcurl"), ("dds/", "Cyclone"), ("civetweb.h", "civetweb"), ("CLI/", "CLI11"), ("rigcal/", "librigcal"),
]
EVERYWHERE = {"expected", "Eigen"}  # the two that public headers may show


class Row:
    """`allowed`: columns marked for the whole module, or None: all; `in_folder`: others, marked for some folders of it."""
    def __init__(self, module, allowed, in_folder, libraries):
        self.module, self.allowed, self.in_folder, self.libraries = module, allowed, in_folder, libraries

    def allows(self, path, target):
        if self.allowed is None or target == self.module or target in self.allowed:
            return True
        return any(str(path).startswith(folder + "/") for folder in self.in_folder.get(target, []))


def module_name(column):
    return f"server/{column}" if column in FOLDERS else column


def parse_table(text):
    rows, columns = {}, []
    for line in text.splitlines():
        if not line.startswith("|") or set(line) <= set("|- "):
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if cells[0] == "module":
            columns = [module_name(cell) for cell in cells[1:-1]]
            continue
        marks = dict(zip(columns, cells[1:-1]))
        allowed = {column for column, mark in marks.items() if mark == "x"}
        in_folder = {column: mark.split(", ") for column, mark in marks.items() if "/" in mark}
        rows[cells[0]] = Row(cells[0], None if cells[1] == "everything" else allowed, in_folder, cells[-1])
    return rows


def libraries_for(row, path):
    """'A, B; some/folder: C' gives A and B everywhere, C in the folder."""
    names = set(EVERYWHERE)
    for part in row.libraries.split(";"):
        folder, _, listed = part.rpartition(":")
        if not folder or str(path).startswith(folder.strip() + "/"):
            names |= {name.strip().split(" ")[0] for name in listed.split(",")}
    return names


def module_of(path, rows):
    """The longest row that the path lies in."""
    matches = [name for name in rows if str(path) == name or str(path).startswith(name + "/")]
    return max(matches, key=len, default=None)


def library_of(include):
    """The library's name; '' for the standard library and POSIX; None if unknown."""
    if "/" not in include and "." not in include or POSIX.fullmatch(include):
        return ""
    return next((name for prefix, name in LIBRARIES if include.startswith(prefix)), None)


def includes_of(text):
    return [(bracket == "<", name) for bracket, name in INCLUDE.findall(text)]


def quoted_problem(path, include, rows):
    row = rows[module_of(path, rows)]
    if "/" not in include:  # generated into the module's own build folder
        return None if include not in IDL_GENERATED or row.module == "idl" else f"{include} belongs to idl"
    target = module_of(include, rows)
    if target is None:
        return f'"{include}" lies in no module of {TABLE}'
    if row.allows(path, target):
        return None
    return f'{row.module} may not include {target} ("{include}")'


def library_problem(path, include, rows):
    row, library = rows[module_of(path, rows)], library_of(include)
    if library is None:
        return f"<{include}> is of no library that the test knows"
    if library == "" or row.allowed is None or library in libraries_for(row, path):
        return None
    return f"{row.module} may not use {library} (<{include}>)"


def public_headers(texts, rows):
    """Headers that another module sees, directly or through other headers."""
    seen, waiting = set(), []
    for path, text in texts.items():
        names = [name for angled, name in includes_of(text) if not angled]
        waiting += [name for name in names if module_of(name, rows) not in (None, module_of(path, rows))]
    while waiting:
        name = waiting.pop()
        if name not in seen and name in texts:
            seen.add(name)
            waiting += [other for angled, other in includes_of(texts[name]) if not angled]
    return seen


def public_problem(path, include, rows):
    if module_of(path, rows) == "idl" or library_of(include) in EVERYWHERE | {""}:
        return None
    return f"a header that other modules include may not show <{include}>"


def problems(texts, rows):
    found, public = [], public_headers(texts, rows)
    for path, text in texts.items():
        if module_of(path, rows) is None:
            found.append(f"{path}: lies in no module of {TABLE}")
            continue
        for angled, include in includes_of(text):
            checks = [library_problem] if angled else [quoted_problem]
            checks += [public_problem] if angled and path in public else []
            found += [f"{path}: {why}" for why in (check(path, include, rows) for check in checks) if why]
    return found


class TheProject(unittest.TestCase):
    def test_keeps_to_the_table(self):
        rows = parse_table(sources.read(TABLE))
        texts = {str(path): sources.read(path) for path in sources.tracked()
                 if path.suffix in (".h", ".cc") and path.parts[0] in ("server", "storage", "client", "idl")}
        self.assertGreater(len(texts), 20, "the sources were not found")
        self.assertEqual([], problems(texts, rows))


class TheCheck(unittest.TestCase):
    ROWS = parse_table("| module | base | idl | graph | libraries |\n|---|---|---|---|---|\n"
                       "| server/base | | | | TBB |\n| server/graph | x | | | Ceres |\n| idl | x | | | Cyclone |\n"
                       "| client | x | x | client/check, client/companion | CLI11; client/sim: OpenCV |\n| server/main.cc | everything | | | |\n")

    def found(self, path, line, **more):
        return problems({path: line, **{k.replace("__", "/") + ".h": v for k, v in more.items()}}, self.ROWS)

    def test_allows_what_is_marked(self):
        for path, line in [("server/graph/a.cc", '#include "server/base/b.h"'), ("server/base/a.cc", "#include <map>"),
                           ("server/graph/a.cc", '#include "server/graph/b.h"'), ("idl/a.cc", '#include "rigcal.h"'),
                           ("server/main.cc", '#include "client/b.h"'), ("client/sim/a.cc", "#include <opencv2/core.hpp>"),
                           ("client/a.cc", "#include <unistd.h>"), ("client/a.cc", "#include <Eigen/Core>"),
                           ("client/check/a.cc", '#include "server/graph/b.h"'), ("client/companion/a.cc", '#include "server/graph/b.h"'), ("client/a.cc", '#include "client/check/b.h"')]:
            self.assertEqual([], self.found(path, line), (path, line))

    def test_finds_what_is_not(self):
        for path, line in [("server/base/a.cc", '#include "server/graph/b.h"'), ("client/a.cc", '#include "rigcal.h"'),
                           ("client/a.cc", "#include <opencv2/core.hpp>"), ("server/base/a.cc", "# include <ceres/x.h>"),
                           ("server/base/a.cc", "#include <unheard/of.h>"), ("server/new/a.cc", "#include <map>"),
                           ("server/base/a.cc", '  #include "server/main.cc"'), ("client/a.cc", '#include "tests/x.h"'),
                           ("client/a.cc", '#include "server/graph/b.h"'), ("client/checks.cc", '#include "server/graph/b.h"')]:
            self.assertEqual(1, len(self.found(path, line)), (path, line))

    def test_knows_public_headers_through_others(self):
        seen = '#include "server/base/outer.h"'
        inner = {"server__base__inner": "#include <tbb/x.h>", "server__base__outer": '#include "server/base/inner.h"'}
        self.assertEqual(1, len(self.found("client/a.cc", seen, **inner)))
        self.assertEqual([], self.found("server/base/a.cc", seen, **inner))


if __name__ == "__main__":
    unittest.main()

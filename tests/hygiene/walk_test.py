"""The newcomer's walk of server/README.md: files that are there, each once, no more than a person reads, and each reached by the includes of
those before it."""
import pathlib
import re
import unittest

import sources

PAGE, HEADING = "server/README.md", "## A newcomer's walk\n"
STOP = re.compile(r"^(\d+)\. `([^`]+)`: (\S.*\.)$")
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
STOPS_MAX = 25


def parts_of(page):
    """Of each part of the walk, which begins with a line that ends in a colon, its stops: (number, path, what happens there)."""
    parts = []
    for line in page.split(HEADING)[1].split("\n## ")[0].split("\n"):
        stop = STOP.match(line)
        if stop:
            parts[-1].append((int(stop.group(1)), stop.group(2), stop.group(3)))
        elif line.endswith(":"):
            parts.append([])
    return parts


def header_of(path, read):
    """That which a source file implements: by the rule of style its first, unless it has none of its own."""
    own = str(pathlib.PurePosixPath(path).with_suffix(".h"))
    included = INCLUDE.findall(read(path))
    folder = [name for name in included if pathlib.PurePosixPath(name).parent == pathlib.PurePosixPath(path).parent]
    return {own} if own in included else set(folder)


def reached_from(path, read):
    """All headers of ours that the file includes, and theirs."""
    reached, left = set(), INCLUDE.findall(read(path))
    while left:
        name = left.pop()
        if name not in reached:
            reached.add(name)
            left += INCLUDE.findall(read(name))
    return reached


def faults_of(parts, read):
    """What does not hold of a walk; `read`: a file's text, empty where there is none."""
    stops = [stop for part in parts for stop in part]
    paths = [path for _, path, _ in stops]
    faults = ["there is no %s" % path for path in paths if not read(path)]
    faults += ["%s is named twice" % path for path in sorted(set(paths)) if paths.count(path) > 1]
    faults += ["stop %d is the %d." % (number, at) for at, (number, _, _) in enumerate(stops, 1) if number != at]
    if len(stops) > STOPS_MAX:
        faults.append("%d files, more than %d" % (len(stops), STOPS_MAX))
    for part in parts:
        reached = set()
        for at, (_, path, _) in enumerate(part):
            if at > 0 and not header_of(path, read) & reached:
                faults.append("%s is reached from none before it" % path)
            reached |= reached_from(path, read)
    return faults


class TheWalk(unittest.TestCase):
    def test_holds(self):
        tracked = {str(path) for path in sources.tracked()}
        parts = parts_of(sources.read(PAGE))
        self.assertEqual([], faults_of(parts, lambda path: sources.read(path) if path in tracked else ""))
        self.assertEqual("client/push/push.cc", parts[0][0][1])
        self.assertTrue(parts[-1][-1][1].startswith("server/http/"))


class TheCheck(unittest.TestCase):
    PAGE = "# a\n" + HEADING + "words\n\nHere:\n1. `a/a.cc`: does it.\n2. `b/b.cc`: goes on.\n\nThere:\n3. `c/c.cc`: ends.\n\n## Next\n4. `d.cc`: no.\n"
    FILES = {"a/a.cc": '#include "a/a.h"\n\n#include "a/deep.h"\n', "a/a.h": "x", "a/deep.h": '#include "b/b.h"\n', "b/b.h": "x",
             "b/b.cc": '#include "b/b.h"\n', "c/c.cc": "x"}

    def faults(self, page, **files):
        return faults_of(parts_of(page), lambda path: {**self.FILES, **files}.get(path, ""))

    def test_finds_nothing_wrong(self):
        self.assertEqual([["a/a.cc", "b/b.cc"], ["c/c.cc"]], [[path for _, path, _ in part] for part in parts_of(self.PAGE)])
        self.assertEqual([], self.faults(self.PAGE))

    def test_finds(self):
        self.assertEqual(["there is no gone.cc"], self.faults(self.PAGE.replace("c/c.cc", "gone.cc")))
        self.assertEqual(["a/a.cc is named twice"], self.faults(self.PAGE.replace("c/c.cc", "a/a.cc")))
        self.assertEqual(["stop 4 is the 3."], self.faults(self.PAGE.replace("3. ", "4. ")))
        self.assertEqual(["b/b.cc is reached from none before it"], self.faults(self.PAGE, **{"a/deep.h": "x"}))
        many = "".join("%d. `f%d`: is.\n" % (at, at) for at in range(1, 27))
        self.assertIn("26 files, more than 25", faults_of(parts_of(HEADING + "Here:\n" + many), lambda path: "x"))


if __name__ == "__main__":
    unittest.main()

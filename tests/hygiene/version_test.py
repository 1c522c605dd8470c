"""One version: of CMake (and so of the binaries and the package), of the pages' scripts, and the newest of CHANGELOG.md."""
import json
import re
import unittest

import sources


def first(pattern, path):
    found = re.search(pattern, sources.read(path), re.MULTILINE)
    return found.group(1) if found else None


class TheVersion(unittest.TestCase):
    def test_is_the_same_everywhere(self):
        version = first(r"^project\(rigcal VERSION (\S+) ", "CMakeLists.txt")
        self.assertRegex(version, r"^\d+\.\d+\.\d+$")
        self.assertEqual(version, first(r"^## (\S+)$", "CHANGELOG.md"))
        for name in ("package.json", "package-lock.json"):
            self.assertEqual(version, json.loads(sources.read("web-static/" + name))["version"], name)


if __name__ == "__main__":
    unittest.main()

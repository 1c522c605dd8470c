"""docs/glossary.md against the sources, and docs/README.md against docs: what they name is there, and nothing is left out."""
import re
import unittest

import sources

PAGE, INDEX, COLUMNS = "docs/glossary.md", "docs/README.md", 5
QUOTED = re.compile(r"`([^`]+)`")
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")


def rows_of(text):
    """The cells of each term's row; heads and lines between them are no terms."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return [row for row in rows if row[0] != "term" and not set(row[0]) <= {"-"}]


def places_of(cell):
    """(names, paths) that stand quoted in a cell 'in the code'."""
    quoted = QUOTED.findall(cell)
    return [name for name in quoted if "/" not in name], [name for name in quoted if "/" in name]


def faults_of(row, read):
    """What does not hold of a row; `read`: the text of a file, None where there is none."""
    if len(row) != COLUMNS or not all(row):
        return ["%s: a term, its symbol, what it is, where it is, its source; `-` for none" % row[0]]
    names, paths = places_of(row[3])
    texts = {path: read(path) for path in paths}
    faults = [] if paths else ["%s: no file is named" % row[0]]
    faults += ["%s: there is no %s" % (row[0], path) for path, text in texts.items() if text is None]
    whole = "\n".join(text for text in texts.values() if text)
    return faults + ["%s: no `%s` in %s" % (row[0], name, ", ".join(paths)) for name in names if not re.search(r"\b%s\b" % name, whole)]


class TheProject(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tracked = {str(path) for path in sources.tracked()}
        cls.rows = rows_of(sources.read(PAGE))

    def read(self, path):
        return sources.read(path) if path in self.tracked else None

    def test_terms_are_where_they_are_said_to_be(self):
        self.assertGreater(len(self.rows), 50)
        self.assertEqual([], [fault for row in self.rows for fault in faults_of(row, self.read)])

    def test_a_term_has_one_row(self):
        terms = [row[0] for row in self.rows]
        self.assertEqual(sorted(set(terms)), sorted(terms))

    def test_the_index_has_every_document(self):
        documents = {path[len("docs/"):] for path in self.tracked if re.fullmatch(r"docs/[\w-]+\.md", path)} - {"README.md"}
        self.assertGreater(len(documents), 20)
        self.assertEqual(set(), documents - set(LINK.findall(sources.read(INDEX))))


class TheCheck(unittest.TestCase):
    def test_finds(self):
        files = {"a/b.h": "struct Edge {"}
        self.assertEqual([], faults_of(rows_of("| term | x |\n|---|---|\n| edge | `T` | it | `Edge`, `a/b.h` | - |")[0], files.get))
        for row in ("| edge | `T` | it | `Edg`, `a/b.h` | - |", "| edge | `T` | it | `Edge`, `a/c.h` | - |", "| edge | `T` | it | Edge | - |",
                    "| edge | `T` | it | `a/b.h` | |", "| edge | `T` | it | `a/b.h` |"):
            self.assertEqual(1, len(rows_of(row)))
            self.assertNotEqual([], faults_of(rows_of(row)[0], files.get), row)


if __name__ == "__main__":
    unittest.main()

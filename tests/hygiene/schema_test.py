"""storage/schema: every migration in the folder of its number, and built in, in order."""
import re
import unittest

import sources

FOLDER, BUILD = "storage/schema/", "storage/CMakeLists.txt"
A_FOLDER = 25  # numbers


def place_of(name):
    """Where a migration belongs: '0038_x.sql' in '0026-0050/'."""
    first = (int(name[:4]) - 1) // A_FOLDER * A_FOLDER + 1
    return "%s%04d-%04d/%s" % (FOLDER, first, first + A_FOLDER - 1, name)


def built_in(text):
    return ["storage/" + path for path in re.findall(r"\bschema/\S+?\.sql", text)]


class TheProject(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.paths = [str(path) for path in sources.tracked() if str(path).startswith(FOLDER)]

    def test_each_is_in_the_folder_of_its_number(self):
        self.assertGreater(len(self.paths), 30)
        for path in self.paths:
            self.assertRegex(path, r"/\d{4}_\w+\.sql$")
            self.assertEqual(place_of(path.rsplit("/", 1)[1]), path)

    def test_numbers_are_given_once(self):
        numbers = [path.rsplit("/", 1)[1][:4] for path in self.paths]
        self.assertEqual(sorted(set(numbers)), sorted(numbers))

    def test_all_are_built_in_in_order(self):
        self.assertEqual(sorted(self.paths), built_in(sources.read(BUILD)))


class TheCheck(unittest.TestCase):
    def test_places(self):
        self.assertEqual(["storage/schema/0001-0025/0025_a.sql", "storage/schema/0026-0050/0026_a.sql"],
                         [place_of("0025_a.sql"), place_of("0026_a.sql")])

    def test_reads_the_build(self):
        self.assertEqual(["storage/schema/a/0001_b.sql", "storage/schema/a/0002_c.sql"],
                         built_in("FILES schema/a/0001_b.sql\n schema/a/0002_c.sql)\n postgres/x.sql"))


if __name__ == "__main__":
    unittest.main()

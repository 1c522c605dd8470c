"""Words that the project does without."""
import re
import unittest

import sources

UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
TRANSFORM_NAME = re.compile(r"\bT_\w*_to_")
SLEEP = re.compile(r"\b(sleep_for|sleep_until|usleep|nanosleep|time\.sleep)\b")
MACHINE_PATH = re.compile(r"(?<![\w./}~>:-])/(home|root|work|tmp)(?=/|\b)")
RENAMED = {  # names that only their author understood: the word that the field has for it (docs/glossary.md)
    "AddFigures": "AddMetrics", "Claims": "RobotLocks", "DropStrays": "DropGridOutliers", "ForgetLonelyBoards": "DropUnderobservedBoards",
    "Glance": "Snapshot", "Hanging": "LeafVertices", "HoldUntold": "ConstrainUnobservable", "IsBent": "NeedsRelinearization",
    "LetRest": "BackOff", "ReachOf": "ObservableByMotion", "SeePictures": "DetectInImages", "SolveHonestly": "SolveWithJackknife",
    "Straighten": "Relinearize", "Strays": "GridOutliers", "TakeHonest": "ApplyJackknifeCovariance", "ToldBy": "ObservedDirections"}
RENAMED_IN = ("server/calib/", "server/detect/", "server/graph/", "server/math/", "server/pipeline/")
OUTSIDE_LINK = re.compile(r"https?://(?!www\.w3\.org/)[\w.]", re.IGNORECASE)


def is_self(path):
    return path.parts[:2] == ("tests", "hygiene")


def is_page(path):
    return path.parts[0] == "web-static" or path.parts[:3] == ("server", "report", "templates")


def lines_with(pattern, paths):
    """'path:line: text' of every match."""
    return [f"{path}:{number}: {line.strip()}"
            for path in paths
            for number, line in enumerate(sources.read(path).splitlines(), 1)
            if pattern.search(line)]


def renamed_in(text):
    """Names of before that stand in C++ as names."""
    return sorted(set(re.findall(r"\w+", sources.code_of(text))) & set(RENAMED))


class TheProject(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.paths = [path for path in sources.tracked() if not is_self(path) and path.name != "LICENSE"]

    def test_the_sources_are_found(self):
        self.assertGreater(len(self.paths), 50)

    def test_nothing_is_left_unfinished(self):
        self.assertEqual([], lines_with(UNFINISHED, self.paths))

    def test_transform_names_do_not_say_to(self):
        code = [path for path in self.paths if path.suffix != ".md"]  # prose may say what is banned
        self.assertEqual([], lines_with(TRANSFORM_NAME, code))

    def test_names_are_words_of_the_field(self):
        found = {f"{path}: {old}, which is {RENAMED[old]}"
                 for path in self.paths if path.suffix in (".cc", ".h") and str(path).startswith(RENAMED_IN)
                 for old in renamed_in(sources.read(path))}
        self.assertEqual(set(), found)

    def test_tests_do_not_sleep(self):
        self.assertEqual([], lines_with(SLEEP, [path for path in self.paths if path.parts[0] == "tests"]))

    def test_no_path_of_one_machine(self):
        self.assertEqual([], lines_with(MACHINE_PATH, self.paths))

    def test_pages_do_not_link_outside(self):
        self.assertEqual([], lines_with(OUTSIDE_LINK, [path for path in self.paths if is_page(path)]))


class TheCheck(unittest.TestCase):
    def test_finds(self):
        for pattern, line in [(UNFINISHED, "// TODO: later"), (TRANSFORM_NAME, "Se3 T_cam_to_lidar;"),
                              (SLEEP, "std::this_thread::sleep_for(1s);"),
                              (MACHINE_PATH, 'open("/tmp/x")'), (MACHINE_PATH, "cd /work"),
                              (OUTSIDE_LINK, '<a href="https://example.org">')]:
            self.assertRegex(line, pattern)

    def test_finds_names_of_before(self):
        self.assertEqual(["Claims", "ReachOf"], renamed_in("Claims c;  // Strays\nauto r = ReachOf(x); int IsBentBefore;"))

    def test_lets_pass(self):
        for pattern, line in [(UNFINISHED, "rigcal-XXXXXX"), (TRANSFORM_NAME, "T_a_b, days_to_seconds"),
                              (MACHINE_PATH, "${TMPDIR:-/tmp}/x"), (MACHINE_PATH, "a/work/b, /worker, /tmpfs"),
                              (OUTSIDE_LINK, 'xmlns="http://www.w3.org/2000/svg"')]:
            self.assertNotRegex(line, pattern)


if __name__ == "__main__":
    unittest.main()

"""Every C++ source is laid out as .clang-format says (`deploy/format` does it)."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import sources

ROOT = pathlib.Path(__file__).resolve().parents[2]


def check(folder):
    """What `deploy/format --check` of the project in `folder` says."""
    return subprocess.run([folder / "deploy/format", "--check"], capture_output=True, text=True)


class TheProject(unittest.TestCase):
    def test_is_laid_out_as_said(self):
        checked = check(ROOT)
        named = sorted({line.split(":")[0] for line in checked.stderr.splitlines() if "error:" in line})
        self.assertEqual([], named, "run deploy/format")
        self.assertEqual(0, checked.returncode, checked.stderr)
        self.assertGreater(sum(path.suffix in (".cc", ".h") for path in sources.tracked()), 100)


class TheCheck(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "deploy").mkdir()
        shutil.copy(ROOT / "deploy/format", self.folder / "deploy/format")
        shutil.copy(ROOT / ".clang-format", self.folder)
        (self.folder / "odd.cc").write_text("int  F( ){ return 1 ;}\n")
        subprocess.run("git init -q && git add .", shell=True, cwd=self.folder, check=True)

    def test_names_what_differs_and_changes_nothing(self):
        checked = check(self.folder)
        self.assertNotEqual(0, checked.returncode)
        self.assertIn("odd.cc", checked.stderr)
        self.assertEqual("int  F( ){ return 1 ;}\n", (self.folder / "odd.cc").read_text())

    def test_finds_nothing_after_it_was_laid_out(self):
        subprocess.run([self.folder / "deploy/format"], check=True)
        self.assertEqual("int F() { return 1; }\n", (self.folder / "odd.cc").read_text())
        self.assertEqual(0, check(self.folder).returncode)


if __name__ == "__main__":
    unittest.main()

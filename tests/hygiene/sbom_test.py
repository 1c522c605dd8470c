"""The list of what the package is made of: SPDX 2.3, whole, and the same each time. usage: sbom_test.py, with RIGCAL_BIN."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "deploy" / "packaging" / "sbom.py"
PROGRAMS = ["rigcald", "rigcal-worker", "rigcal", "rigcal-simulate", "rigcal-check", "rigcal-companion", "rigcal-board", "rigcal-import", "rigcal-upkeep"]
IDENTIFIER = re.compile(r"SPDXRef-[A-Za-z0-9.-]+$")
LICENCE = re.compile(r"NOASSERTION$|[A-Za-z0-9.+-]+( (AND|OR) [A-Za-z0-9.+-]+)*$")
sys.path.insert(0, str(SCRIPT.parent))
import sbom  # noqa: E402


def make(folder, *programs):
    file = pathlib.Path(folder, "sbom.json")
    done = subprocess.run([sys.executable, str(SCRIPT), "--version", "1.2.3", "--epoch", "1700000000", "--packages", str(ROOT / "deploy" / "packages.txt"),
                           "--lock", str(ROOT / "web-static" / "package-lock.json"), "--output", str(file), *map(str, programs)], capture_output=True, text=True)
    return done, file.read_text() if file.exists() else ""


def installed_programs():
    folder = pathlib.Path(os.environ.get("RIGCAL_BIN", ""))
    return [folder / name for name in PROGRAMS if (folder / name).is_file()]


class Words(unittest.TestCase):
    def test_licences_are_spelt_as_spdx_does(self):
        for debian, spdx in (("Expat", "MIT"), ("LGPL-2.1+", "LGPL-2.1-or-later"), ("GPL-2", "GPL-2.0-only"), ("BSD-3-clause or GPL-2", "BSD-3-Clause OR GPL-2.0-only"),
                             ("Artistic-of-mine", None), ("Expat and odd", None)):
            self.assertEqual(spdx, sbom.spdx_licence(debian), debian)


@unittest.skipIf(not installed_programs(), "no programs: give RIGCAL_BIN")
class TheList(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        done, cls.text = make(cls.folder.name, *installed_programs())
        assert done.returncode == 0, done.stderr
        cls.made = json.loads(cls.text)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_it_has_what_spdx_requires(self):
        made = self.made
        self.assertEqual(("SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT", "rigcal-1.2.3"), (made["spdxVersion"], made["dataLicense"], made["SPDXID"], made["name"]))
        self.assertRegex(made["documentNamespace"], r"^https://[^#]+$")
        self.assertEqual("2023-11-14T22:13:20Z", made["creationInfo"]["created"])
        self.assertTrue(all(re.match(r"(Person|Organization|Tool): ", one) for one in made["creationInfo"]["creators"]))
        for part in made["packages"]:
            self.assertRegex(part["SPDXID"], IDENTIFIER)
            self.assertTrue(part["name"] and part["versionInfo"] and part["downloadLocation"] and part["copyrightText"], part)
            self.assertIs(False, part["filesAnalyzed"])
            for licence in (part["licenseConcluded"], part["licenseDeclared"]):
                self.assertRegex(licence, LICENCE)

    def test_relations_are_between_what_is_there(self):
        known = [part["SPDXID"] for part in self.made["packages"]]
        self.assertEqual(len(known), len(set(known)))
        related = {end for one in self.made["relationships"] for end in (one["spdxElementId"], one["relatedSpdxElement"])}
        self.assertEqual(set(known) | {"SPDXRef-DOCUMENT"}, related)
        self.assertIn({"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-rigcal"}, self.made["relationships"])

    def test_every_library_that_is_linked_is_in_it(self):
        listed = {name for part in self.made["packages"] for name in part.get("comment", "").removeprefix("libraries: ").split(", ")}
        for program in installed_programs():
            told = subprocess.run(["readelf", "--dynamic", "--wide", str(program)], capture_output=True, text=True, check=True).stdout
            for name in re.findall(r"\(NEEDED\).*\[(.+)\]", told):
                if not name.startswith("ld-linux"):
                    self.assertIn(name, listed, program)

    def test_versions_are_those_installed(self):
        for part in self.made["packages"]:
            if part["SPDXID"].startswith("SPDXRef-deb-"):
                told = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", part["name"]], capture_output=True, text=True, check=True).stdout
                self.assertEqual(told, part["versionInfo"], part["name"])

    def test_the_packages_of_the_pages_are_in_it(self):
        npm = {part["name"] for part in self.made["packages"] if part["SPDXID"].startswith("SPDXRef-npm-")}
        self.assertTrue({"three", "echarts", "zrender"} <= npm and not {"esbuild", "playwright-core"} & npm, npm)

    def test_it_is_the_same_each_time(self):
        self.assertEqual(self.text, make(self.folder.name, *reversed(installed_programs()))[1])

    def test_a_library_that_is_no_packages_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            program, library = pathlib.Path(folder, "odd"), pathlib.Path(folder, "libodd.so")
            subprocess.run(["gcc", "-shared", "-o", str(library), "-x", "c", "-"], input="int odd(void) { return 1; }", text=True, check=True)
            subprocess.run(["gcc", "-o", str(program), "-x", "c", "-", "-L" + folder, "-lodd", "-Wl,-rpath," + folder], input="int odd(void); int main(void) { return odd(); }",
                           text=True, check=True)
            done, _ = make(folder, program)
        self.assertEqual((1, "sbom.py: no Debian package has libodd.so"), (done.returncode, done.stderr.strip().replace(folder + "/", "")))


if __name__ == "__main__":
    unittest.main()

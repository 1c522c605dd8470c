"""librigcal: header, list of symbols and Python's table name the same functions; Python's values, apart from any server."""
import math
import re
import sys
import unittest

import sources

FOLDER = "client/library"
sys.path.insert(0, str(sources.ROOT / FOLDER / "python"))
import rigcal  # noqa: E402
from rigcal import client as by_dds  # noqa: E402
from rigcal.questions import error_of  # noqa: E402

HEADER = sources.read(FOLDER + "/include/rigcal/c_api.h")
C_TYPES = {"int": "c_int", "int64_t": "c_long", "size_t": "c_ulong", "double": "c_double"}


def members(name):
    """(type, name) of each member of a struct of the header."""
    body = next(body for body, of in re.findall(r"typedef struct \{(.*?)\} (\w+);", HEADER, re.DOTALL) if of == name)
    return re.findall(r"^\s*(?:const )?(\w+ ?\*?) ?(\w+)(?:\[\d+\])?;", body, re.MULTILINE)


class TheSurface(unittest.TestCase):
    def test_is_the_same_everywhere(self):
        declared = set(re.findall(r"^RIGCAL_API .*?\b(rigcal_\w+)\(", HEADER, re.MULTILINE))
        self.assertGreater(len(declared), 10)
        self.assertEqual(declared, set(re.findall(r"rigcal_\w+(?=;)", sources.read(FOLDER + "/librigcal.map"))))
        self.assertLessEqual(set(by_dds._FUNCTIONS), declared)

    def test_structs_have_the_members_of_the_header(self):
        for name, ours in (("rigcal_options", by_dds._Options), ("rigcal_standing", by_dds._Standing), ("rigcal_push_options", by_dds._PushOptions),
                           ("rigcal_push_result", by_dds._PushResult), ("rigcal_calibration", by_dds._Calibration)):
            wanted = [(field, C_TYPES.get(kind, "c_char_p" if kind == "char*" else "c_void_p" if kind.endswith("*") else "_Standing"))
                      for kind, field in ((kind.strip(), field) for kind, field in members(name))]
            self.assertEqual(wanted, [(field, kind.__name__) for field, kind in ours._fields_], name)

    def test_codes_are_those_of_the_header(self):
        codes = {name.lower(): int(code) for name, code in re.findall(r"RIGCAL_([A-Z_]+) = (\d)", HEADER)}
        self.assertEqual(codes, {name: code for code, name in enumerate(by_dds.CODES)})


class Poses(unittest.TestCase):
    def test_matrix_and_back(self):
        third = math.sqrt(1 / 3)
        for q in ((0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.6, 0.0, 0.0, 0.8),
                  (third, -third, third, 0.0), (0.5, -0.5, 0.5, 0.5)):
            back = rigcal.Pose.of_matrix(rigcal.Pose((1.0, 2.0, 3.0), q).matrix())
            self.assertAlmostEqual(1.0, abs(sum(a * b for a, b in zip(back.q_xyzw, q))), 12)
            self.assertEqual((1.0, 2.0, 3.0), back.p_m)

    def test_what_is_no_rigid_motion_is_refused(self):
        rigid = rigcal.Pose((1.0, 2.0, 3.0), (0.6, 0.0, 0.0, 0.8)).matrix()
        scaled = [[1000 * value for value in row[:3]] + [row[3]] for row in rigid[:3]] + [rigid[3]]
        mirrored = [[-value for value in row[:3]] + [row[3]] for row in rigid[:3]] + [rigid[3]]
        columns = [list(column) for column in zip(*rigid)]
        for T, word in ((scaled, "length 1"), (mirrored, "mirrors"), ([[0.0] * 4] * 4, "last row"), (columns, "last row"),
                        ([[math.nan] * 4] * 4, "finite"), (rigid[:3], "four rows")):
            with self.assertRaisesRegex(rigcal.RigcalError, word):
                rigcal.Pose.of_matrix(T)

    def test_a_quarter_turn_about_z_takes_x_to_y(self):
        half = math.sqrt(0.5)
        T = rigcal.Pose((0.0, 0.0, 5.0), (0.0, 0.0, half, half)).matrix()
        self.assertEqual([0.0, 1.0, 0.0, 0.0], [round(row[0], 12) for row in T])
        self.assertEqual(5.0, T[2][3])


class Errors(unittest.TestCase):
    def test_an_error_document_is_one_sentence(self):
        error = error_of(b'{"error": {"code": "not_found", "what": "robot \'x\' is not known", "cure": "Ask for another"}}', "")
        self.assertEqual(("not_found", "robot 'x' is not known. Ask for another."), (error.code, str(error)))

    def test_a_page_of_another_server_is_not_read_as_one(self):
        for body in (b"<html>", b"[]", b'{"error": null}', b'{"error": {"code": 1}}'):
            self.assertEqual("unreachable", error_of(body, "no").code)


if __name__ == "__main__":
    unittest.main()

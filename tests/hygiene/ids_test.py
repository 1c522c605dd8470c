"""docs/ids.md: its recipe gives the ids of tests/golden, and its vectors are those. The C++ side is tests/unit/formats/ids_test.cc."""
import hashlib
import json
import re
import unittest

import sources

PAGE = "docs/ids.md"


def recipe():
    """The functions of the page, as it has them."""
    functions = {}
    exec(re.search(r"```python\n(.*?)```", sources.read(PAGE), re.DOTALL).group(1), functions)
    return functions


class TheRecipe(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page, cls.functions = sources.read(PAGE), recipe()
        cls.batches = json.loads(sources.read("tests/golden/ids.json"))

    def test_gives_the_golden_ids(self):
        self.assertEqual(3, len(self.batches))
        for batch in self.batches:
            ids = self.functions["edge_ids"](batch["robot"], batch["edges"])
            self.assertEqual(batch["edge_ids"], ids)
            self.assertEqual(batch["batch_id"], self.functions["batch_id"](batch["robot"], ids))

    def test_the_first_is_on_the_page(self):
        first = self.batches[0]
        for name, wanted in (("content", self.functions["content"](first["edges"][0])), ("edge_id", first["edge_ids"][0]),
                             ("batch_id", first["batch_id"])):
            self.assertEqual(wanted, re.search(r"^%s +([0-9a-f]{64})$" % name, self.page, re.MULTILINE).group(1))

    def test_equal_edges_count(self):
        twice = self.batches[1]["edges"][:2]
        self.assertEqual(*map(self.functions["content"], twice))
        self.assertEqual(2, len(set(self.batches[1]["edge_ids"][:2])))

    def test_signs_do_not_count(self):
        edge = self.batches[1]["edges"][2]
        T = {"p_m": [-value if value == 0 else value for value in edge["T_a_b"]["p_m"]], "q_xyzw": [-value for value in edge["T_a_b"]["q_xyzw"]]}
        self.assertEqual(self.functions["content"](edge), self.functions["content"]({**edge, "T_a_b": T}))

    def test_a_session_is_hashed_as_python_writes_it(self):
        golden = sources.read("tests/golden/manifest.json")
        written = json.dumps(json.loads(golden), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        self.assertEqual(golden, written)
        self.assertIn("session_id  " + hashlib.sha256(written.encode()).hexdigest(), self.page)


if __name__ == "__main__":
    unittest.main()

"""docs/metrics.md, the dashboard and the alerts against the sources: each name is one that the server exports, with labels that it has."""
import json
import re
import unittest

import sources

PAGE, DASHBOARD, ALERTS = "docs/metrics.md", "deploy/grafana/rigcal.json", "deploy/grafana/alerts.yml"
LITERAL = re.compile(r'"(rigcal_[a-z0-9_]+)"(?:,\s*"|\)\s*\.Help\()')  # with its help beside it
NAME = re.compile(r"\b(rigcal_[a-z0-9_]+)(?:\{([^}]*)\})?")
MATCHER = re.compile(r"(\w+)\s*(?:=~|!~|!=|=)")
EXPRESSION = re.compile(r"^\s*expr:\s*(\S.*)$", re.MULTILINE)
GROUPED = re.compile(r"\bby\s*\(([^)]*)\)")
UNITS = ("_seconds", "_bytes", "_total", "_info", "_limit")
COUNTED = {"edges", "sessions", "robots", "handles", "failing", "waiting", "open", "status", "rule"}  # no unit: a number of things, or 0 and 1
PARTS_OF_A_HISTOGRAM = ("_bucket", "_count", "_sum")


def exported():
    """Names in the server's sources; of histograms as they are declared."""
    return {name for path in sources.tracked() if path.parts[0] == "server" and path.suffix == ".cc"
            for name in LITERAL.findall(sources.read(path))}


def rows_of(text):
    """name: (type, labels)"""
    rows = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) == 4 and re.fullmatch(r"`rigcal_\w+`", cells[0]):
            rows[cells[0].strip("`")] = (cells[1], set(re.findall(r"`(\w+)`", cells[2])))
    return rows


def problems(expression, rows):
    """What is wrong with an expression of PromQL: names that nobody exports, labels that a name does not have."""
    found, labels_seen = [], {"le"}
    for name, matchers in NAME.findall(expression):
        family = next((name[:-len(end)] for end in PARTS_OF_A_HISTOGRAM if name.endswith(end) and name[:-len(end)] in rows), name)
        if family not in rows:
            found.append(f"{name} is not exported: {expression}")
            continue
        kind, labels = rows[family]
        if (kind == "histogram") != (family != name):
            found.append(f"{name} is a {kind}: {expression}")
        labels_seen |= labels
        found += [f"{name} has no label {label}: {expression}" for label in MATCHER.findall(matchers) if label not in labels | {"le"}]
    for listed in GROUPED.findall(expression):
        found += [f"no label {label}: {expression}" for label in re.findall(r"\w+", listed) if label not in labels_seen]
    return found


def expressions_of_dashboard(text):
    return [target["expr"] for panel in json.loads(text)["panels"] for target in panel.get("targets", [])]


class TheProject(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rows = rows_of(sources.read(PAGE))

    def test_the_page_names_what_the_server_exports(self):
        self.assertGreater(len(self.rows), 25)
        self.assertEqual(exported(), set(self.rows))

    def test_units_stand_last(self):
        for name, (kind, _) in self.rows.items():
            self.assertTrue(name.endswith(UNITS) or name.rsplit("_", 1)[1] in COUNTED, name)
            self.assertEqual(kind == "counter", name.endswith("_total"), name)

    def test_the_dashboard_shows_what_there_is(self):
        expressions = expressions_of_dashboard(sources.read(DASHBOARD))
        self.assertGreater(len(expressions), 10)
        self.assertEqual([], [why for expression in expressions for why in problems(expression, self.rows)])

    def test_the_alerts_watch_what_there_is(self):
        text = sources.read(ALERTS)
        expressions = EXPRESSION.findall(text)
        self.assertGreater(len(expressions), 8)
        self.assertEqual(len(expressions), text.count("- alert:"))
        self.assertEqual([], [why for expression in expressions for why in problems(expression, self.rows)])

    def test_every_queue_stage_and_error_is_shown(self):
        shown = " ".join(expressions_of_dashboard(sources.read(DASHBOARD)))
        wanted = [name for name in self.rows if re.search("waiting|_duration_|errors|failures|refusals|_open", name)]
        self.assertEqual([], [name for name in wanted if name not in shown])


class TheCheck(unittest.TestCase):
    ROWS = rows_of("| `rigcal_a_seconds` | histogram | `stage` | x |\n| `rigcal_b_total` | counter | - | y |\n| name | type | labels | z |\n")

    def test_reads_rows(self):
        self.assertEqual({"rigcal_a_seconds": ("histogram", {"stage"}), "rigcal_b_total": ("counter", set())}, self.ROWS)

    def test_lets_pass(self):
        for expression in ['histogram_quantile(0.99, sum by (le, stage) (rate(rigcal_a_seconds_bucket{stage="solve"}[5m])))',
                           "increase(rigcal_b_total[1h]) > 0"]:
            self.assertEqual([], problems(expression, self.ROWS))

    def test_finds(self):
        for expression in ["rigcal_c_total", 'rigcal_b_total{kind="x"}', "rate(rigcal_a_seconds[5m])", "sum by (kind) (rigcal_b_total)",
                           "rigcal_b_total_bucket"]:
            self.assertEqual(1, len(problems(expression, self.ROWS)), expression)


if __name__ == "__main__":
    unittest.main()

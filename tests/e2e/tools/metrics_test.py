"""What operators watch, on a real server: /metrics is read line by line before and after a session is pushed, and what happened moved its
figures; the log is one JSON object a line, with the ids of that session."""
import json
import math
import pathlib
import re
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402

ROBOT = "watched"
SAMPLE = re.compile(r'([a-z_:][a-z0-9_:]*)(\{(?:\w+="(?:[^"\\\n]|\\.)*",?)*\})? (\S+)')
TYPE = re.compile(r"# TYPE (\w+) (counter|gauge|histogram)")
PARTS = ("_bucket", "_count", "_sum")


def parse(text):
    """({name: type}, {name with labels: value}); every line is one of the format, every sample follows its type."""
    types, samples, newest = {}, {}, None
    check(text.endswith("\n"), "the last line ends")
    for line in text.splitlines():
        if line.startswith("# HELP "):
            continue
        of_type, sample = TYPE.fullmatch(line), SAMPLE.fullmatch(line)
        if of_type:
            newest = of_type.group(1)
            check(newest not in types, "one type per name: " + line)
            types[newest] = of_type.group(2)
            continue
        check(sample, "a line of the format: " + line)
        name, key = sample.group(1), sample.group(1) + (sample.group(2) or "")
        parts = [newest + part for part in PARTS] if types[newest] == "histogram" else [newest]
        check(name in parts, "below its type: " + line)
        check(key not in samples, "once: " + line)
        samples[key] = float(sample.group(3))
        check(not math.isnan(samples[key]), "a number: " + line)
    return types, samples


def scrape(flow):
    return parse(flow.get("/metrics"))


def histograms_are_whole(types, samples):
    for name in (name for name, kind in types.items() if kind == "histogram"):
        rows = {}
        for key, value in samples.items():
            if key.startswith(name + "_bucket{"):
                bound = re.search(r',?le="([^"]+)"', key)
                labels = key[len(name + "_bucket"):].replace(bound.group(0), "")
                rows.setdefault(labels, []).append((float(bound.group(1).replace("+Inf", "inf")), value))
        check(rows, name + " has buckets")
        for labels, buckets in rows.items():
            counts = [count for _, count in sorted(buckets)]
            check(counts == sorted(counts) and sorted(buckets)[-1][0] == math.inf, "%s%s grows: %r" % (name, labels, buckets))
            check(counts[-1] == samples[name + "_count" + labels], "%s%s: all are counted" % (name, labels))


def push_session(flow):
    folder = flow.folder / "session"
    flow.rigcal("simulate", front_rig(flow, ROBOT, "rig"), "--out", folder, "--seed", 1, "--captures", 20, "--scale", 0.3, "--captured-at", "2026-01-31")
    return json.loads(flow.rigcal("push", folder, "--json").stdout)["id"]


def moved(before, after, key, least=1):
    check(after[key] >= before[key] + least, "%s moved: %r, %r" % (key, before[key], after[key]))


def figures_move(flow):
    types, before = scrape(flow)
    histograms_are_whole(types, before)
    check(before["rigcal_jobs_waiting"] == 0 and before["rigcal_oldest_job_waiting_seconds"] == 0, "nothing waits at first")
    check(before['rigcal_receipts_total{state="closed"}'] == 0, "nothing came at first")
    check(before["rigcal_sessions_open_limit"] > 0 and before["rigcal_intake_limit_bytes"] > 0, "limits are told")
    session = push_session(flow)
    wait_published(flow)
    types, after = scrape(flow)
    histograms_are_whole(types, after)
    for stage in ("receive", "detect", "calibrate", "solve", "report"):
        moved(before, after, 'rigcal_stage_duration_seconds_count{stage="%s"}' % stage)
        check(after['rigcal_stage_failures_total{stage="%s"}' % stage] == 0, stage + " did not fail")
    moved(before, after, 'rigcal_receipts_total{state="closed"}')
    moved(before, after, "rigcal_received_bytes_total", 1000)
    moved(before, after, 'rigcal_edges_calibrated_total{state="good"}')
    check(sum(after[key] for key in after if key.startswith("rigcal_revisions_total")) >= 1, "a revision was made")
    moved(before, after, 'rigcal_answer_duration_seconds_count{channel="dds"}')
    moved(before, after, 'rigcal_answer_duration_seconds_count{channel="http"}')
    check(after["rigcal_sessions"] == 1 and after["rigcal_sessions_open"] == 0, "it is stored and closed")
    check(after["rigcal_intake_waiting_bytes"] == 0 and after["rigcal_jobs_waiting"] == 0, "nothing waits any more")
    check(after["rigcal_resident_memory_bytes"] > 1e6 and after["rigcal_open_handles"] > 3, "the process tells of itself")
    return session


def errors_are_counted(flow):
    _, before = scrape(flow)
    check(flow.server.rigcal("show", "nobody").returncode != 0, "a robot that nobody knows is not shown")
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0)]}))
    flow.rigcal("push-edges", path, "--robot", "edges-only")
    _, after = scrape(flow)
    moved(before, after, 'rigcal_answer_failures_total{channel="dds",kind="not_found"}')
    moved(before, after, "rigcal_edges_pushed_total")


def log_is_json(flow, session):
    time_of = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z")
    rows = [json.loads(line) for line in pathlib.Path(str(flow.server.data) + ".log").read_text().splitlines()]
    for row in rows:
        check(list(row)[:3] == ["time", "level", "event"] and list(row)[-1] == "text", "in this order: %r" % row)
        check(time_of.fullmatch(row["time"]) and row["level"] in ("info", "warning", "error"), "time and level: %r" % row)
    of = {event: [row for row in rows if row["event"] == event] for event in ("receipt", "edge", "revision")}
    check(any(row.get("robot") == ROBOT and row.get("session") == session for row in of["receipt"]), "a receipt: %r" % of["receipt"])
    check(any(row["robot"] == ROBOT and row["session"] == session and row["job"].isdigit() for row in of["edge"]), "an edge: %r" % of["edge"])
    check(any(row["robot"] == ROBOT and "revision 1" in row["text"] for row in of["revision"]), "a revision: %r" % of["revision"])


def scrapes_are_quick(flow):
    took = []
    for _ in range(10):
        began = time.monotonic()
        flow.get("/metrics")
        took.append(time.monotonic() - began)
    check(min(took) < 0.2, "a scrape costs little: %r" % took)


def main():
    flow = Flow()
    try:
        flow.server.start("--log", "json")
        flow.address = flow.ready()
        session = figures_move(flow)
        errors_are_counted(flow)
        scrapes_are_quick(flow)
    finally:
        flow.server.stop()
    try:
        log_is_json(flow, session)
    finally:
        flow.temporary.cleanup()
    print("metrics: good")


main()

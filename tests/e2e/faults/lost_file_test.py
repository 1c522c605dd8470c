"""A byte flipped in a stored picture: named, never used, sent again by pushing again, and the robot gets its revision."""
import hashlib
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, stereo_pairs  # noqa: E402
from measures.sessions import picture_session  # noqa: E402

VERDICT_FAIL = 1  # exit code of doctor as well


def blob_of(flow, payload):
    digest = hashlib.sha256(payload.read_bytes()).hexdigest()
    return flow.folder / "store" / "blobs" / digest[:2] / digest


def flip_a_byte(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def edges_of(flow):
    return json.loads(flow.rigcal("show", "stereo", "--json").stdout)["document"]["edges"]


def main():
    with Flow() as flow:
        session = picture_session(flow.folder / "session", "stereo", stereo_pairs(flow.context))
        # The first push brings the pictures; the second searches them for another board, once one of them is damaged.
        header = session / "session.yaml"
        text = header.read_text()
        header.write_text(text.replace("[9, 6]", "[8, 6]"))
        flow.server.rigcal("push", session)
        header.write_text(text)
        damaged = session / "left" / "03.jpg"
        flip_a_byte(blob_of(flow, damaged))

        flow.server.rigcal("push", session)
        failed = [edge for edge in edges_of(flow) if edge["diagnoses"][0]["code"] == "file_lost"]
        check(len(failed) == 1, "one edge says so: %r" % edges_of(flow))
        what = failed[0]["diagnoses"][0]["what"]
        check("robot stereo" in what and "left/03.jpg (damaged)" in what, "robot and file are named: " + what)
        aside = blob_of(flow, damaged).with_name(blob_of(flow, damaged).name + ".damaged")
        check(aside.exists() and not blob_of(flow, damaged).exists(), "the damaged file is kept aside")
        told = flow.rigcal("doctor", exit_code=VERDICT_FAIL).stdout
        check("left/03.jpg" in told and "Push their sessions again" in told, "doctor names it: " + told)

        again = json.loads(flow.rigcal("push", session, "--json").stdout)
        check(again["total"] - again["held_before"] == damaged.stat().st_size, "only that file travelled: %r" % again)
        good = [edge for edge in edges_of(flow) if edge["state"] == "good"]
        check(len(good) == 1, "the pair was run again: %r" % edges_of(flow))
        baseline_m = sum(value * value for value in good[0]["T_a_b"]["p_m"]) ** 0.5
        check(abs(baseline_m - 0.08318) < 0.0003, "baseline %.6f m" % baseline_m)
        check("none is known to be damaged" in flow.rigcal("doctor").stdout, "all is well")
    print("lost file: good")


main()

"""`rigcal push BAG`: the same poses as the folder, nothing left behind, goes on where it was cut off, tells what is missing."""
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import SKIPPED, Flow, check  # noqa: E402
from lidar_rig import rig_of  # noqa: E402
from measures.tools.bags import session_bags  # noqa: E402

USAGE, UNREACHABLE, REFUSED, WARN = 2, 3, 4, 5


def edge_of(flow, robot):
    edge, = json.loads(flow.rigcal("show", robot, "--json").stdout)["document"]["edges"]
    check(edge["state"] == "good", "an edge: %r" % edge)
    return [*edge["T_a_b"]["p_m"], *edge["T_a_b"]["q_xyzw"]]


def same_edge(flow, robot, wanted):
    off = max(abs(a - b) for a, b in zip(edge_of(flow, robot), wanted))
    check(off <= 1e-9, "the pose of %s is the folder's: %g" % (robot, off))


def rig_for(flow, visit, robot):
    path = flow.folder / (robot + ".yaml")
    path.write_text(session_bags.rig_of(visit, robot))
    return path


def every_container_gives_the_folders_pose(flow, visit, bags, wanted):
    for container, bag in bags.items():
        done = flow.rigcal("push", bag, "--rig", rig_for(flow, visit, "of-" + container), "--new-robot")
        check("captures of messages within" in done.stderr and "is stored" in done.stderr, "what was read and sent is told: " + done.stderr)
        same_edge(flow, "of-" + container, wanted)
        check(not list(flow.folder.glob("*.rigcal-push")), "the folder is gone")


def cut_off_goes_on(flow, visit, bag, wanted):
    rig, kept = rig_for(flow, visit, "cut"), flow.folder / "visit.mcap.rigcal-push"
    words = ("push", bag, "--rig", rig, "--new-robot")
    flow.server.kill()
    said = flow.rigcal(*words, "--timeout-total", 1, "--timeout", 1, exit_code=UNREACHABLE).stderr
    check(kept.is_dir() and str(kept) in said, "without a server the folder stays, and that is told: " + said)
    (kept / "session.yaml").unlink()
    clouds = sorted(kept.glob("*/*.pcd"))
    clouds[0].unlink()
    inode = clouds[1].stat().st_ino
    check(flow.rigcal(*words, "--timeout-total", 1, "--timeout", 1, exit_code=UNREACHABLE).returncode == UNREACHABLE, "again")
    check(clouds[0].exists() and clouds[1].stat().st_ino == inode, "only what is missing is written")
    flow.server.start()
    flow.address = flow.ready()
    rig.write_text(rig.read_text().replace("sensors:\n", "import: {tolerance_s: 0.004}\nsensors:\n"))
    flow.rigcal(*words)  # what was left of another rig.yaml is in nobody's way
    same_edge(flow, "cut", wanted)
    check(not kept.exists(), "the folder is gone")


def what_was_lost_is_told_again(flow, visit, bag):
    """The folder was whole, and only the server was missing: the next push knows what the first one read."""
    cut = flow.folder / "cut.mcap"
    cut.write_bytes(bag.read_bytes()[:int(bag.stat().st_size * 0.7)])
    words = ("push", cut, "--rig", rig_for(flow, visit, "lossy"), "--new-robot", "--no-wait")
    flow.server.kill()
    said = flow.rigcal(*words, "--timeout-total", 1, "--timeout", 1, exit_code=UNREACHABLE).stderr
    check("could be read is given" in said, "what is lost is told: " + said)
    flow.server.start()
    flow.address = flow.ready()
    said = flow.rigcal(*words, exit_code=WARN).stderr
    check("holds this import already" in said and "could be read is given" in said, "and told again: " + said)


def two_drives_of_one_name(flow, visit, bag):
    """Whose folder it is when both begin is asked, not guessed: neither session has captures of the other."""
    other = flow.folder / "other"
    flow.rigcal("simulate", rig_of(flow), "--out", other, "--seed", 2, "--captures", 8)
    (flow.folder / "drive").mkdir()
    second = session_bags.bags_of(other, flow.folder / "drive")[bag.suffix[1:]]
    check(second.name == bag.name, "the same name")
    alone = json.loads(flow.rigcal("push", second, "--rig", rig_for(flow, other, "second"), "--new-robot", "--no-wait", "--json").stdout)["id"]
    jobs = [(bag, rig_for(flow, visit, "first")), (second, flow.folder / "second.yaml")]
    running = [subprocess.Popen(flow.server.client("push", path, "--rig", rig, "--work", flow.folder / "work", "--new-robot", "--no-wait", "--json"),
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=flow.server.environment()) for path, rig in jobs]
    ended = [(process.communicate(timeout=120), process.returncode) for process in running]
    refused = [said for (_, said), code in ended if code == REFUSED]
    check(all("is in use by another import or push" in said for said in refused), "one waits for the other: %r" % ended)
    check(len(refused) <= 1 and all(code in (0, REFUSED) for _, code in ended), "one at least is sent: %r" % ended)
    again = json.loads(flow.rigcal("push", second, "--rig", flow.folder / "second.yaml", "--work", flow.folder / "work", "--no-wait", "--json").stdout)
    check(again["id"] == alone, "the same captures as by itself")


def usage_is_told(flow, visit, bag):
    said = flow.rigcal("push", bag, exit_code=USAGE).stderr
    check("--rig FILE" in said and "--write-rig" in said, "a bag needs a rig: " + said)
    said = flow.rigcal("push", visit, "--rig", flow.folder / "of-mcap.yaml", exit_code=USAGE).stderr
    check("are for bags" in said, "a folder has none: " + said)
    (flow.folder / "no.bag").write_text("hello, this is no bag")
    said = flow.rigcal("push", flow.folder / "no.bag", "--rig", flow.folder / "of-mcap.yaml", exit_code=REFUSED).stderr
    check(said.count("\n") == 1 and not (flow.folder / "no.bag.rigcal-push").exists(), "one sentence, no folder: " + said)


def full_disk_is_told_beforehand(flow, visit, bag):
    place = pathlib.Path(tempfile.mkdtemp(prefix="rigcal-disk-"))
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(place)], capture_output=True, text=True)
    if mounted.returncode != 0:
        place.rmdir()
        print("SKIPPED at its end: may not mount a small disk: " + mounted.stderr.strip())
        raise SystemExit(SKIPPED)
    try:
        said = flow.rigcal("push", bag, "--rig", rig_for(flow, visit, "full"), "--work", place, exit_code=REFUSED).stderr
        check("and its disk has" in said and "free" in said, "the room is told: " + said)
        check(not list(place.glob("*/*/*.pcd")), "before anything is written")
    finally:
        subprocess.run(["umount", str(place)], check=True)
        place.rmdir()


def main():
    with Flow() as flow:
        visit = flow.folder / "visit"
        flow.rigcal("simulate", rig_of(flow), "--out", visit, "--seed", 1, "--captures", 8)
        flow.rigcal("push", visit)
        wanted = edge_of(flow, "pair")
        bags = session_bags.bags_of(visit, flow.folder)
        every_container_gives_the_folders_pose(flow, visit, bags, wanted)
        cut_off_goes_on(flow, visit, bags["mcap"], wanted)
        what_was_lost_is_told_again(flow, visit, bags["mcap"])
        two_drives_of_one_name(flow, visit, bags["mcap"])
        usage_is_told(flow, visit, bags["mcap"])
        full_disk_is_told_beforehand(flow, visit, bags["mcap"])
    print("push_bag: good")


main()

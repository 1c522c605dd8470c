"""Backups while a server is pushed to, killed in their middle; restored, checked, a byte flipped, mended, and the robot has its pose again."""
import json
import pathlib
import random
import signal
import subprocess
import sys

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1]), str(pathlib.Path(__file__).resolve().parent)]
from flow import Flow, Server, check, stereo_pairs, wait_published  # noqa: E402
from measures.service.flips import flip  # noqa: E402
from report_again_test import await_page  # noqa: E402
from measures.sessions import noise_session, picture_session  # noqa: E402

DAMAGE, REFUSED = 1, 4  # exit codes
KILLS = 8


def upkeep(flow, *arguments, exit_code=0):
    return flow.rigcal(*arguments, exit_code=exit_code)


def killed_in_the_middle(flow, backup, chance):
    """Whether it was under way; what it left is as good as before."""
    command = flow.server.client("backup", backup, "--data", flow.server.data)
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=flow.server.environment())
    try:
        process.wait(timeout=chance.uniform(0.0, 0.25))
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
    return process.wait() == -signal.SIGKILL


def backups_with_kills(flow, backup):
    chance = random.Random(20261126)
    under_way = 0
    for number in range(KILLS):
        robot = "filler-%d" % number
        flow.rigcal("push", noise_session(flow.folder / robot, robot, 500_000, 20, number), "--no-wait", exit_code=0)
        under_way += killed_in_the_middle(flow, backup, chance)
        place = flow.folder / ("restored-%d" % number)
        upkeep(flow, "restore-backup", backup, place)
        upkeep(flow, "fsck", place)
    check(under_way > 0, "no backup was killed in its middle")
    document = json.loads(upkeep(flow, "backup", backup, "--data", flow.server.data, "--json").stdout)
    check(document["lost"] == [] and document["files"] >= KILLS * 20, "all files are in the next one: %r" % document)


def private(backup, told):
    """Pictures and passwords' hashes are in it."""
    modes = {path.stat().st_mode & 0o777 for path in backup.rglob("*") if path.is_file()}
    check(backup.stat().st_mode & 0o777 == 0o700 and modes == {0o600}, "it is its user's alone: %r" % modes)
    check("others on this machine" not in told, "and needs no note: " + told)


def refusals(flow, backup):
    told = upkeep(flow, "restore-backup", backup, flow.server.data, exit_code=REFUSED).stderr
    check("a rigcald uses the data folder" in told, "a folder in use is refused: " + told)
    told = upkeep(flow, "fsck", flow.server.data, "--repair", exit_code=REFUSED).stderr
    check("without --repair it may serve meanwhile" in told, "no repair while it serves: " + told)
    told = upkeep(flow, "restore-backup", backup, flow.folder / "session", exit_code=REFUSED).stderr
    check("is not empty" in told, "a folder that holds something is refused: " + told)


def served_from_the_backup(flow, backup, shown):
    """The flow goes on with what was restored."""
    flow.server.stop()
    restored = flow.folder / "new-store"
    upkeep(flow, "restore-backup", backup, restored)
    flow.server = Server(flow.context, restored)
    flow.server.start()
    flow.address = flow.ready()
    check(json.loads(flow.rigcal("show", "stereo", "--json").stdout)["digest"] == shown["digest"], "the same revision")
    await_page(flow, "/robots/stereo/revisions/1/")


def mended_after_a_flip(flow, session):
    data = flow.server.data
    flow.server.stop()
    picture = next(path for path in sorted((data / "blobs").glob("??/*")) if path.read_bytes() == (session / "left" / "03.jpg").read_bytes())
    flip(picture, 1000)
    told = upkeep(flow, "fsck", data, exit_code=DAMAGE).stdout
    check("left/03.jpg of session" in told and "of robot stereo is damaged" in told, "session and robot are named: " + told)
    told = upkeep(flow, "fsck", data, "--repair", exit_code=DAMAGE).stdout
    check("Push the session again" in told and picture.with_name(picture.name + ".damaged").exists(), "set aside: " + told)
    told = upkeep(flow, "fsck", data, exit_code=DAMAGE).stdout
    check("lost: left/03.jpg of session" in told, "a later look tells that it is lost: " + told)
    check("nothing else is damaged; 1 files that robots pushed are lost until they are pushed again.\n" in told, "and counts it: " + told)
    told = json.loads(upkeep(flow, "fsck", data, "--json", exit_code=DAMAGE).stdout)
    check((told["damaged"], told["lost"]) == (0, 1), "for programs, too: %r" % told)
    flow.server.start()
    flow.address = flow.ready()
    again = json.loads(flow.rigcal("push", session, "--json").stdout)
    check(again["total"] - again["held_before"] == (session / "left" / "03.jpg").stat().st_size, "only that file travelled: %r" % again)
    told = upkeep(flow, "fsck", data).stdout
    check("nothing is damaged" in told, "all is well: " + told)


def what_a_backup_lost_is_sent_again(flow, session, backup):
    """Of a picture that the backup holds damaged nobody is told that it is here."""
    flow.server.stop()
    wanted = (session / "left" / "04.jpg").read_bytes()
    flip(next(path for path in sorted((backup / "blobs").glob("??/*")) if path.read_bytes() == wanted), 1000)
    restored = flow.folder / "restored-with-loss"
    told = upkeep(flow, "restore-backup", backup, restored, exit_code=DAMAGE).stdout
    check("left/04.jpg of session" in told and "Push these sessions again" in told, "it is named: " + told)
    flow.server = Server(flow.context, restored)
    flow.server.start()
    flow.address = flow.ready()
    again = json.loads(flow.rigcal("push", session, "--json").stdout)
    check(again["total"] - again["held_before"] == len(wanted), "that file travelled, and no other: %r" % again)
    check("nothing is damaged" in upkeep(flow, "fsck", restored).stdout, "all is well")


def what_is_not_a_restores_stays(flow, backup):
    beside = flow.folder / "place.restoring"
    beside.mkdir()
    (beside / "mine").write_text("precious")
    told = upkeep(flow, "restore-backup", backup, flow.folder / "place", exit_code=REFUSED).stderr
    check("no restore has left it" in told and (beside / "mine").exists(), "it is refused by name: " + told)


def main():
    with Flow() as flow:
        session = picture_session(flow.folder / "session", "stereo", stereo_pairs(flow.context))
        flow.rigcal("push", session)
        wait_published(flow)
        shown = json.loads(flow.rigcal("show", "stereo", "--json").stdout)
        backup = flow.folder / "backup"
        told = upkeep(flow, "backup", backup, "--data", flow.server.data).stderr
        private(backup, told)
        backups_with_kills(flow, backup)
        refusals(flow, backup)
        served_from_the_backup(flow, backup, shown)
        mended_after_a_flip(flow, session)
        what_is_not_a_restores_stays(flow, backup)
        what_a_backup_lost_is_sent_again(flow, session, backup)
        check(flow.get("/readyz") == "ready\n", "ready")
    print("backup: good")


main()

"""Every case of the table against one server: the sentence, the exit code, nothing stored unseen, and the server serves on."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from bad_inputs_check import Checker, run_all  # noqa: E402
from flow import Flow, check  # noqa: E402

RSS_MAX_MIB = 300


def main():
    with Flow() as flow:
        checker = Checker(flow.server, flow.address, flow.folder)
        outcomes = run_all(checker, print, only=" ".join(sys.argv[1:]))
        wrong = [case.name for case, problem in outcomes if problem]
        problem = checker.good_session_calibrates()
        check(not problem, "a good session calibrates afterwards: " + problem)
        peak_mib = flow.server.peak_rss_mib()
        check(peak_mib <= RSS_MAX_MIB, "memory of the server: %.0f MiB" % peak_mib)
        check(not wrong, "%d of %d cases: %s" % (len(wrong), len(outcomes), "; ".join(wrong)))
    print("bad inputs: %d cases, all as the table says; %.0f MiB" % (len(outcomes), peak_mib))


main()

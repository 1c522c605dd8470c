"""The table of bad inputs against one server, the decoders under fuzz, and one robot's flood beside another's questions."""
import pathlib
import sys

from ..measure import at_least, at_most, equal
from ..server import Server
from . import fuzz

E2E = pathlib.Path(__file__).resolve().parents[3] / "tests" / "e2e"
sys.path[:0] = [str(E2E / "hostile"), str(E2E)]


def table(context):
    from bad_inputs_check import Checker, run_all  # draws its pictures when it is imported
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        server = Server(context, folder / "store").start()
        try:
            address = server.wait_address()
            checker = Checker(server, address, folder)
            outcomes = run_all(checker, lambda line: print(line, file=sys.stderr))
            problem = checker.good_session_calibrates()
            yield at_least("cases", len(outcomes), 60)
            yield equal("cases_with_the_expected_sentence", sum(not wrong for _, wrong in outcomes), len(outcomes))
            yield equal("good_session_calibrates_afterwards", int(not problem), 1)
            yield equal("server_up", int(server.process.poll() is None and checker.healthy()), 1)
            yield at_most("peak_rss", server.peak_rss_mib(), 300.0, "MiB")
        finally:
            server.stop()


def run(context):
    yield from table(context)
    yield from fuzz.run(context)
    from . import flood
    yield from flood.run(context)

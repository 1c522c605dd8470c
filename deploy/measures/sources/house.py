"""The state of the code base against its goals, read from the sources alone: sizes, contracts, includes, repetition, tests.

Product code is what git tracks of *.cc and *.h in server, storage, client and idl. Lines are those that `wc -l` counts."""
import collections
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tests" / "hygiene"))
import include_table_test as table  # noqa: E402
import sources  # noqa: E402
import words_test  # noqa: E402

from ..measure import at_least, at_most, between, equal, info  # noqa: E402
from . import include_graph, same_tokens  # noqa: E402
from .cpp_outline import Outline, comment_lines  # noqa: E402

SERVER_LINES_MAX = 42000
FOLDER_FILES_MAX = 30
METHODS_MAX, MEMBERS_MAX = 12, 8  # of a class
SAME_TOKENS = 60
PRODUCT = ("server", "storage", "client", "idl")


def lines(text):
    return text.count("\n")


def percent(part, whole):
    return 100.0 * part / max(whole, 1)


def code(folders, suffixes=(".cc", ".h")):
    return {str(path): sources.read(path) for path in sources.tracked() if path.suffix in suffixes and path.parts[0] in folders}


def sizes(product, tests):
    of_server = sum(lines(text) for path, text in product.items() if path.startswith("server/"))
    yield at_most("server_lines_of_cc_and_h_with_blank_ones", of_server, SERVER_LINES_MAX)
    yield between("median_lines_of_product_files", statistics.median(map(lines, product.values())), 80, 150)
    written = sum(lines(text) for path, text in tests.items() if not path.startswith("tests/bench/"))
    yield at_least("lines_of_tests_without_bench_per_product_line", written / sum(map(lines, product.values())), 0.8)


def folders(product):
    held = collections.Counter(str(pathlib.PurePosixPath(path).parent) for path in product if not path.startswith("idl/"))
    full = sorted("%s: %d files" % (folder, count) for folder, count in held.items() if count > FOLDER_FILES_MAX)
    yield equal("folders_with_more_than_%d_code_files" % FOLDER_FILES_MAX, len(full), 0, full)


def classes(outlines):
    """A constructor, destructor or operator is a method, unless defaulted or deleted. A struct without methods is not a
    class but a row of values: those are told without a limit."""
    large, rows = [], []
    for path, outline in outlines.items():
        for one in outline.classes:
            told = "%s:%d %s: %d methods, %d members" % (path, one.line, one.name, len(one.methods), len(one.members))
            if not one.methods and len(one.members) > MEMBERS_MAX:
                rows.append(told)
            elif len(one.methods) > METHODS_MAX or len(one.members) > MEMBERS_MAX:
                large.append(told)
    yield equal("classes_over_%d_methods_or_%d_members" % (METHODS_MAX, MEMBERS_MAX), len(large), 0, large)
    yield info("structs_of_values_over_%d_members" % MEMBERS_MAX, len(rows), detail=rows)


def arrows(product):
    rows = table.parse_table(sources.read(table.TABLE))
    by_file = include_graph.includes(product)
    by_module = include_graph.between(by_file, lambda path: table.module_of(path, rows) or "")
    cycles = [" ".join(cycle) for cycle in include_graph.cycles(by_file) + include_graph.cycles(by_module)]
    yield equal("include_cycles", len(cycles), 0, cycles)
    up = include_graph.upward(product, rows)
    yield equal("upward_includes", len(up), 0, up)


def repetition(product):
    paths = [path for path in product if path.startswith("server/")]
    pairs = same_tokens.same_stretches([same_tokens.tokens(product[path]) for path in paths], SAME_TOKENS)
    told = ["%s:%d %s:%d" % (paths[f], a, paths[g], b) for (f, a), (g, b) in pairs]
    yield at_most("pairs_in_server_of_%d_tokens_same_but_for_names" % SAME_TOKENS, len(pairs), 60, detail=told)


def comments(product):
    alone, beside = (sum(map(len, numbers)) for numbers in zip(*map(comment_lines, product.values())))
    filled = sum(1 for text in product.values() for line in text.splitlines() if line.strip())
    yield at_least("lines_with_a_comment_of_all", percent(alone + beside, sum(map(lines, product.values()))), 12.0, "%")
    yield info("lines_of_comment_alone_of_those_not_blank", percent(alone, filled), "%")


def contracts(outlines):
    """A prototype has one where a comment stands directly above it or on its line, or above a row of prototypes without
    a blank line in which it stands. Asked of functions in headers that whoever includes them can call; not of
    destructors, of what is defaulted or deleted, nor of overrides, whose contract is that of what they override."""
    headers = {path: outline for path, outline in outlines.items() if path.endswith(".h") and not path.startswith("idl/")}
    prototypes = [(path, one) for path, outline in headers.items() for one in outline.prototypes]
    bare = ["%s:%d %s" % (path, one.first, one.name) for path, one in prototypes if not one.covered]
    yield at_least("public_prototypes_with_a_contract", percent(len(prototypes) - len(bare), len(prototypes)), 95.0, "%", bare)


def words():
    """Those that tests/hygiene/words_test.py bans everywhere."""
    paths = [path for path in sources.tracked() if not words_test.is_self(path) and path.name != "LICENSE"]
    found = [line for pattern in (words_test.UNFINISHED, words_test.MACHINE_PATH) for line in words_test.lines_with(pattern, paths)]
    yield equal("banned_words", len(found), 0, found)


def run(_):
    product, tests = code(PRODUCT), code(("tests",), (".cc", ".h", ".py"))
    outlines = {path: Outline(text) for path, text in product.items()}
    yield from sizes(product, tests)
    yield from folders(product)
    yield from classes(outlines)
    yield from arrows(product)
    yield from repetition(product)
    yield from comments(product)
    yield from contracts(outlines)
    yield from words()

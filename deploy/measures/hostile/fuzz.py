"""The fuzz targets with libFuzzer and sanitizers: executions and findings of each."""
import os
import pathlib
import re
import subprocess
import sys

from ..measure import at_least, equal, info, skip

QUICK_RUNS, FULL_RUNS = 100_000, 1_000_000
INPUT_BYTES_MAX = 64 << 10
PICTURE_BYTES_MAX = 4096  # larger pictures decode slowly and show nothing else
# The sanitizers take a fifth of the speed: 5 s here is about 1 s of the service.
LIMITS = ["-timeout=5", "-malloc_limit_mb=512", "-rss_limit_mb=1024"]
SANITIZERS = {"ASAN_OPTIONS": "quarantine_size_mb=64:detect_leaks=1:allocator_may_return_null=1", "UBSAN_OPTIONS": "print_stacktrace=1"}
KINDS = ("crash-*", "leak-*", "oom-*", "timeout-*")
STATISTIC = re.compile(r"^stat::(\w+):\s+(\d+)", re.MULTILINE)


def has_runtime(folder):
    """Whether clang can link a fuzz target here."""
    source = pathlib.Path(folder) / "probe.cc"
    source.write_text('extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }\n')
    command = ["clang++", "-fsanitize=fuzzer,address", str(source), "-o", str(source.with_suffix(""))]
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def build(root):
    steps = [["cmake", "--preset", "fuzz"], ["cmake", "--build", "--preset", "fuzz"]]
    for step in steps[(root / "build" / "fuzz" / "build.ninja").exists():]:
        done = subprocess.run(step, cwd=root, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError("%s: %s" % (" ".join(step), (done.stdout + done.stderr)[-600:]))


def statistics(text):
    return {name: int(value) for name, value in STATISTIC.findall(text)}


def fuzz_one(program, corpus, runs, folder):
    """(statistics, paths of findings). The corpus is only read; what is new goes to the folder."""
    found = pathlib.Path(folder) / "found"
    fresh = pathlib.Path(folder) / "corpus"
    found.mkdir(parents=True)
    fresh.mkdir()
    bytes_max = PICTURE_BYTES_MAX if program.name == "fuzz_picture" else INPUT_BYTES_MAX
    command = [str(program), str(fresh), str(corpus), "-runs=%d" % runs, "-seed=1", "-max_len=%d" % bytes_max,
               "-print_final_stats=1", "-artifact_prefix=%s/" % found, *LIMITS]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False, env={**os.environ, **SANITIZERS})
    findings = [path for kind in KINDS for path in found.glob(kind)]
    if done.returncode != 0 or findings:
        print(done.stderr[-4000:], file=sys.stderr)
    if done.returncode != 0 and not findings:
        raise RuntimeError("%s: exit %d" % (program.name, done.returncode))
    return statistics(done.stderr), findings


def keep(findings, folder):
    """Findings outlive the scratch folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in findings:
        (folder / path.name).write_bytes(path.read_bytes())
        print("finding: %s" % (folder / path.name), file=sys.stderr)


def run(context):
    with context.folder() as folder:
        if not has_runtime(folder):
            yield skip("fuzz", "clang has no libFuzzer here: install clang and libclang-rt-14-dev")
            return
        build(context.root)
        runs = FULL_RUNS if context.full else QUICK_RUNS
        for corpus in sorted((context.root / "tests" / "fuzz" / "corpus").iterdir()):
            name = corpus.name
            program = context.root / "build" / "fuzz" / "bin" / ("fuzz_" + name)
            done, findings = fuzz_one(program, corpus, runs, pathlib.Path(folder) / name)
            keep(findings, context.root / "build" / "fuzz" / "findings" / name)
            yield at_least("fuzz_%s_executions" % name, done.get("number_of_executed_units", 0), runs)
            yield info("fuzz_%s_per_s" % name, done.get("average_exec_per_sec", 0))
            yield equal("fuzz_%s_findings" % name, len(findings), 0)

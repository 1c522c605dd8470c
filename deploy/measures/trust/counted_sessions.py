"""Simulated sessions that were judged are kept, so that a count of hours may be broken off and goes on where it was, and what is counted
so far can be told. Kept by the program's own bytes. Another build takes over the count of a scenario where it judges the first and the
last counted session alike, to the last digit; else it counts anew."""
import hashlib
import json
import os
import shutil


class CountedSessions:
    CHUNK = 2 * (os.cpu_count() or 1)  # sessions per run of the program, which uses all processors

    def __init__(self, context, program):
        self.context, self.program = context, program
        with open(context.bin / program, "rb") as file:
            digest = hashlib.sha256(file.read()).hexdigest()[:16]
        self.folder = context.root / "build" / "measure" / program / digest
        self.folder.mkdir(parents=True, exist_ok=True)

    def judged(self, scenario, count, only_counted=False):
        """Sessions `1` to `count` of a scenario in their order; `only_counted`: those of them that were judged before."""
        self._take_over(scenario)
        known = self._read(scenario)
        while not only_counted and (missing := [seed for seed in range(1, count + 1) if seed not in known]):
            first = missing[0]
            run = next((i for i, seed in enumerate(missing[:self.CHUNK]) if seed != first + i), len(missing[:self.CHUNK]))
            told = self.context.run_json(self.program, scenario, run, first, timeout=200000)["sessions"]
            known.update(zip(range(first, first + run), told))
            self._append(scenario, first, told)
        return [known[seed] for seed in range(1, count + 1) if seed in known]

    def _file(self, scenario):
        return self.folder / (scenario + ".jsonl")

    def _take_over(self, scenario):
        """The longest count of another build whose results are this one's."""
        if self._file(scenario).exists():
            return
        for counted in sorted(self.folder.parent.glob("*/" + scenario + ".jsonl"), key=lambda file: file.stat().st_size, reverse=True):
            known = read_sessions(counted)
            if known and all(self._is_judged_alike(scenario, number, known[number]) for number in sorted({min(known), max(known)})):
                shutil.copyfile(counted, self._file(scenario))
                return

    def _is_judged_alike(self, scenario, number, before):
        [now] = self.context.run_json(self.program, scenario, 1, number, timeout=200000)["sessions"]
        return {**now, "judge_s": 0} == {**before, "judge_s": 0}

    def _read(self, scenario):
        return read_sessions(self._file(scenario))

    def _append(self, scenario, first, told):
        with open(self._file(scenario), "a") as file:
            if file.tell() > 0:
                file.write("\n")  # a cut line before it stays a line of its own
            file.write("\n".join(json.dumps({"number": first + i, "session": session}) for i, session in enumerate(told)))


def read_sessions(path):
    """{number: session}; a line that was cut by the end of its writer is counted again."""
    known = {}
    if path.exists():
        for line in path.read_text().splitlines():
            try:
                one = json.loads(line)
            except ValueError:
                continue
            known[one["number"]] = one["session"]
    return known

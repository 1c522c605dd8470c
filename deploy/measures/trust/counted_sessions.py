"""Simulated sessions that were judged are kept, so that a count of hours may be broken off and goes on where it was, and what is counted
so far can be told. Kept by the program's own bytes: another build counts anew."""
import hashlib
import json
import os


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

    def _read(self, scenario):
        """{number: session}; a line that was cut by the end of its writer is counted again."""
        known = {}
        if self._file(scenario).exists():
            for line in self._file(scenario).read_text().splitlines():
                try:
                    one = json.loads(line)
                except ValueError:
                    continue
                known[one["number"]] = one["session"]
        return known

    def _append(self, scenario, first, told):
        with open(self._file(scenario), "a") as file:
            if file.tell() > 0:
                file.write("\n")  # a cut line before it stays a line of its own
            file.write("\n".join(json.dumps({"number": first + i, "session": session}) for i, session in enumerate(told)))

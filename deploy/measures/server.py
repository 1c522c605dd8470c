"""A real rigcald in a process of its own, apart from every other by its discovery tag."""
import contextlib
import os
import pathlib
import signal
import subprocess
import uuid


# How a verb ends that told a robot's verdict: pass, fail, warn, unknown (`rigcal --help`).
ANSWERED = (0, 1, 5, 6)


class Server:
    def __init__(self, context, data, tag=None):
        self.context, self.data = context, pathlib.Path(data)
        self.tag = tag or "measure-" + uuid.uuid4().hex[:12]
        self.process = None

    def environment(self):
        return {**os.environ, "RIGCAL_DDS_TAG": self.tag, "RIGCAL_DDS_LOCAL": "1"}

    def start(self, *arguments):
        self.log = open(str(self.data) + ".log", "a")
        where = () if "--http" in arguments else ("--http", "127.0.0.1:0")
        self.process = subprocess.Popen([str(self.context.bin / "rigcald"), "--data", str(self.data), *where, *arguments],
                                        stdout=subprocess.PIPE, stderr=self.log, text=True, env=self.environment())
        return self

    def wait_address(self):
        """Where its HTTP is."""
        line = self.process.stdout.readline()
        if "ready" not in line:
            raise RuntimeError("rigcald did not start: see %s.log" % self.data)
        return [word for word in line.split() if word.startswith(("http://", "https://"))][0].rstrip("/")

    def wait_ready(self):
        self.address = self.wait_address()
        return self

    def kill(self):
        if self.process and self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
        self.close()

    def stop(self):
        if self.process and self.process.poll() is None:
            self.process.terminate()
        self.close()

    def close(self):
        if self.process:
            try:
                self.process.wait(timeout=90)  # it finishes the calibration that it is at
            except subprocess.TimeoutExpired:
                self.process.kill()  # left running it would slow whatever is measured next
                self.process.wait()
                raise
            self.process.stdout.close()
            self.log.close()
            self.process = None

    def processes(self):
        """The server's and those that work for it."""
        pids = [self.process.pid]
        for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
            with contextlib.suppress(OSError):  # it ended meanwhile
                if int(stat.read_text().rsplit(") ", 1)[1].split()[1]) == self.process.pid:
                    pids.append(int(stat.parent.name))
        return pids

    def rss_mib(self):
        """Of the server alone, now."""
        return next(int(line.split()[1]) / 1024 for line in open("/proc/%d/status" % self.process.pid) if line.startswith("VmRSS"))

    def peak_rss_mib(self):
        """Of all its processes together, as they are now."""
        peaks = [int(line.split()[1]) / 1024 for pid in self.processes() for line in open("/proc/%d/status" % pid) if line.startswith("VmHWM")]
        if not peaks:
            raise RuntimeError("no VmHWM")
        return sum(peaks)

    def client(self, *arguments):
        return [str(self.context.bin / "rigcal"), *map(str, arguments)]

    def rigcal(self, *arguments, timeout=300):
        return subprocess.run(self.client(*arguments), capture_output=True, text=True, env=self.environment(), timeout=timeout)

    def __enter__(self):
        return self.start().wait_ready()

    def __exit__(self, *_):
        self.stop()

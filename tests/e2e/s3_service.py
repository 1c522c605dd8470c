"""An S3 service of its own (tests/s3/with_s3) that can stand still, be killed, and come back at the same address with what it had."""
import os
import signal
import subprocess

from flow import ROOT, SKIPPED, check

PROGRAM = ROOT / "tests/s3/with_s3"


class S3Service:
    def __init__(self, folder):
        self.folder, self.port, self.process = folder, 0, None

    def start(self):
        self.process = subprocess.Popen([PROGRAM, "--folder", self.folder, "--port", str(self.port), "sh", "-c", "env; echo; exec cat"],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        told = {}
        for line in self.process.stdout:
            name, sign, value = line.rstrip("\n").partition("=")
            if not sign and not name:
                break
            told[name] = value
        if "RIGCAL_TEST_S3_PID" not in told:
            check(self.process.wait() == SKIPPED, "the S3 service did not start: %r" % told)
            print("SKIPPED: OpenStack Swift is not installed (apt-get install python3-swift)")
            raise SystemExit(SKIPPED)
        self.pid, self.address, self.bucket = int(told["RIGCAL_TEST_S3_PID"]), told["AWS_ENDPOINT_URL_S3"], told["RIGCAL_TEST_BUCKET"]
        self.port = int(self.address.rsplit(":", 1)[1])
        os.environ.update({name: value for name, value in told.items() if name.startswith("AWS_")})
        return self

    def pause(self):
        os.kill(self.pid, signal.SIGSTOP)

    def resume(self):
        os.kill(self.pid, signal.SIGCONT)

    def stop(self):
        """At once, whatever it is at."""
        if self.process is None:
            return
        os.kill(self.pid, signal.SIGKILL)
        self.process.communicate()
        self.process = None

    def objects(self):
        """How many it has."""
        return len(list(self.folder.glob("devices/disk/objects/*/*/*/*.data")))

    def __enter__(self):
        return self.start()

    def __exit__(self, *_):
        self.stop()

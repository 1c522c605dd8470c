"""Recorded beside power_scene.py: parts of the product by themselves, whose syncs those of a whole server would cover by chance."""
import errno
import pathlib
import subprocess

from disk_record import Recording

KILLED = -9


class ApiScene:
    def __init__(self, context, folder):
        self.folder = pathlib.Path(folder)
        self.program = context.bin / "durable_files"
        self.recording = Recording(context.bin / "librigcal_disk_recorder.so", self.folder / "disk", self.folder / "record")

    def act(self, name, where, failing=None, exit_code=0):
        if failing:
            self.recording.plan.fail(*failing)
        done = subprocess.run([str(self.program), name, str(self.recording.root / where)], env=self.recording.environment(),
                              capture_output=True, text=True, timeout=60)
        if self.recording.plan.end() != bool(failing):
            raise RuntimeError("%s: %r did not fail" % (name, failing))
        if done.returncode != exit_code:
            raise RuntimeError("%s: exit %d: %s" % (name, done.returncode, done.stderr[-300:]))

    def record(self):
        self.act("make-new", "files")
        self.act("write-twice", "files")
        self.act("make-shard-again", "files")
        self.act("keep-blob", "files", failing=("sync", 2, errno.EIO))  # the folder's, after the file's
        self.act("write-bag", "files")
        self.act("write-in-new-folder", "files")
        self.act("add-row", "store")
        self.act("tell-rows", "store")
        self.act("add-row", "store", failing=("sync", 3, 0), exit_code=KILLED)  # after those of a new log and its name
        self.act("tell-rows", "store")
        return self

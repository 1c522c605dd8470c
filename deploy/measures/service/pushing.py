"""A robot that pushes on a thread of its own, one thing after the other without a pause, until it is left."""
import threading

from ..server import ANSWERED


class Pushing:
    """Pushes go on inside `with`. A subclass has `push_next()`: what was refused; empty: nothing, and the next one follows."""

    def __init__(self, server):
        self.server, self.pushed, self.refused = server, 0, ""
        self.stopped, self.thread = threading.Event(), threading.Thread(target=self.run)

    def run(self):
        while not self.stopped.is_set() and not self.refused:
            self.refused = self.push_next()

    def refusal_of(self, *arguments):
        """Of `rigcal ARGUMENTS`."""
        done = self.server.rigcal(*arguments)
        return done.stderr if done.returncode not in ANSWERED else ""

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stopped.set()
        self.thread.join()
        if self.refused:
            raise RuntimeError("%s: %s" % (type(self).__name__, self.refused))

"""`biela studio` with a file, which can be killed and started again."""

import os
import socket
import subprocess
import time

from harness import ROOT, program


class Server:
    """`biela studio` with a file."""

    def __init__(self, *arguments):
        solver = os.environ.get("BIELA_PAGE_SOLVER")
        self.command = [program(), "studio", *arguments, *(["--solver", solver] if solver else [])]
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()

    def stop(self):
        self.process.kill()
        return self.process.communicate()[1]


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(true, seconds=10):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.05)

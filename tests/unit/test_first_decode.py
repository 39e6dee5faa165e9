"""Several threads that decode the first messages of a process at the same time."""

from __future__ import annotations

import subprocess
import sys

from robots import ROOT, untraced

PROGRAM = """
import json, sys, threading
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import messages
sys.setswitchinterval(1e-6)
for vector in json.load(open("schemas/vectors/messages.json")):
    kind = getattr(messages, vector["message"])
    data = bytes.fromhex(vector["msgpack"])
    begin = threading.Barrier(8)
    def decode():
        begin.wait()
        assert isinstance(codec.decode(data, kind), kind)
    threads = [threading.Thread(target=decode) for _ in range(8)]
    for thread in threads: thread.start()
    for thread in threads: thread.join()
print("decoded")
"""


def test_threads_that_decode_a_message_for_the_first_time_do_not_crash() -> None:
    for _ in range(2):  # without the preparation, most of these processes ended by a segmentation fault
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM],
            capture_output=True,
            text=True,
            cwd=ROOT,
            env=untraced(),
            check=False,
            timeout=60.0,
        )
        assert (done.returncode, done.stdout, done.stderr) == (0, "decoded\n", "")

"""Programs with the options and the output of Zenoh's examples, for computers without zenoh-python's folder."""

from __future__ import annotations

from pathlib import Path

BEGIN = """
import argparse, json, threading, zenoh
parser = argparse.ArgumentParser()
for option in "-m", "-e", "-s", "-k", "-p":
    parser.add_argument(option)
given = parser.parse_args()
config = zenoh.Config()
config.insert_json5("mode", json.dumps(given.m))
config.insert_json5("connect/endpoints", json.dumps([given.e]))
print("Opening session...")

def show(replies):
    for reply in replies:
        if reply.ok is None:
            print(f">> Received (ERROR: '{reply.err.payload.to_string()}')")
        else:
            print(f">> Received ('{reply.ok.key_expr}': '{reply.ok.payload.to_string()}')")

with zenoh.open(config) as session:
"""
PROGRAMS = {
    "z_get": "show(session.get(given.s, payload=given.p, timeout=10))",
    "z_put": "session.put(given.k, given.p)",
    "z_get_liveliness": "print(*(reply.ok.key_expr for reply in session.liveliness().get(given.k, timeout=10)))",
    "z_sub": """print(f"Declaring Subscriber on '{given.k}'...", "Press CTRL-C to quit...", sep="\\n")
    subscriber = session.declare_subscriber(given.k, lambda sample: print(sample.payload.to_string(), flush=True))
    threading.Event().wait()""",
}


def write(folder: Path) -> None:
    """Write the programs into a folder."""
    for name, body in PROGRAMS.items():
        (folder / f"{name}.py").write_text(f"{BEGIN}    {body}\n", encoding="utf-8")

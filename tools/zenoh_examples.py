"""Control both robots with Zenoh's example programs: `python tools/zenoh_examples.py FOLDER`.

FOLDER contains the unmodified z_get.py, z_sub.py, z_put.py and z_get_liveliness.py of zenoh-python. The program prints
every call and its output.
"""

from __future__ import annotations

import shlex
import signal
import subprocess
import sys
from pathlib import Path

from beatrix_zenoh.processes import free_port

ROOT = Path(__file__).resolve().parent.parent
ENDPOINT = f"tcp/127.0.0.1:{free_port()}"
CLIENT = ["-m", "client", "-e", ENDPOINT]


def show(command: list[str], result: str) -> None:
    """Print a call and its output."""
    print("$", shlex.join([Path(command[1]).name, *command[2:]]))
    print("\n".join("    " + line for line in result.splitlines()), flush=True)


def call(folder: Path, program: str, *arguments: str) -> str:
    """Run a program to its end; print the call, and return the output."""
    command = [sys.executable, str(folder / program), *CLIENT, *arguments]
    result = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True).stdout
    show(command, result)
    return result


def listen(folder: Path, key: str, lines: int) -> str:
    """Run z_sub.py until it has printed `lines` samples; print the call, and return the output."""
    command = [sys.executable, "-u", str(folder / "z_sub.py"), *CLIENT, "-k", key]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        lines_read = [program.stdout.readline() for _ in range(lines + 3)]
        program.send_signal(signal.SIGINT)
    show(command[:1] + command[2:], "".join(lines_read))
    return "".join(lines_read)


def drive(folder: Path, side: str) -> None:
    """Read, enable, calibrate, turn and stop one robot; raises AssertionError for an unexpected reply."""
    base = f"beatrix/zed/{side}"
    assert f"{base}/@alive" in call(folder, "z_get_liveliness.py", "-k", "beatrix/*/*/@alive")
    assert '"robot":"zed"' in call(folder, "z_get.py", "-s", f"{base}/info")
    assert f"no key '{base}/inof'" in call(folder, "z_get.py", "-s", f"{base}/inof")
    assert '"enabled":false' in call(folder, "z_get.py", "-s", f"{base}/state/status")
    assert "NOT_ENABLED" in call(folder, "z_get.py", "-s", f"{base}/cmd/me/pose?yaw=0.2")
    assert '"result":true' in call(folder, "z_get.py", "-s", f"{base}/cmd/me/command?command=enable")
    assert '"result":true' in call(folder, "z_get.py", "-s", f"{base}/cmd/me/command", "-p", '{"command":2}')
    assert '"phase":"done"' in call(folder, "z_get.py", "-s", f"{base}/cmd/me/pose?yaw=0.35;pitch=-0.17")
    assert '"phase":"done"' in call(
        folder, "z_get.py", "-s", f"{base}/cmd/me/motion?x=0.1;y=0;z=-0.1;speed=0.5"
    )
    assert "position" in call(folder, "z_get.py", "-s", f"{base}/state/positions")
    assert "commanded" in listen(folder, f"{base}/state/positions/json", 2)
    assert "calibrated" in listen(folder, f"{base}/state/status/json", 1)
    long = [sys.executable, str(folder / "z_get.py"), *CLIENT, "-s", f"{base}/cmd/me/pose?yaw=1.5;speed=0.3"]
    with subprocess.Popen(long, stdout=subprocess.PIPE, text=True) as moving:
        while '"moving":true' not in call(folder, "z_get.py", "-s", f"{base}/state/status"):
            pass
        if side == "sim":
            call(folder, "z_put.py", "-k", f"{base}/stop", "-p", "now")
        else:
            assert "rest at" in call(folder, "z_get.py", "-s", f"{base}/stop/me")
        assert moving.stdout is not None
        ended = moving.stdout.read()
    show(long, ended)
    assert "STOPPED" in ended


def main() -> None:
    """Run router, simulation and hardware node as processes, and the examples as clients."""
    folder = Path(sys.argv[1]).resolve()
    beatrix = [sys.executable, "-m", "beatrix_zenoh.cli"]
    name = ["--name", "zed", "--connect", ENDPOINT]
    processes = []
    try:
        for command in (
            [*beatrix, "router", "--listen", ENDPOINT],
            [sys.executable, "-m", "sim_node", *name],
            [sys.executable, "-m", "hw_node", *name, "--port", "virtual:"],
        ):
            process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT)
            processes.append(process)
            assert process.stdout is not None
            assert process.stdout.readline().startswith("ready")
        drive(folder, "sim")
        drive(folder, "hw")
        print("both robots were read, controlled and stopped")
    finally:
        for process in reversed(processes):
            process.send_signal(signal.SIGINT)
            process.wait(10)


if __name__ == "__main__":
    main()

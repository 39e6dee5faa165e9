"""The computers of a school: each reaches only the computer of the router.

If this computer permits network namespaces, each computer of the school is a namespace: a cable of its own links it to
the router's computer, and it has no other route and no multicast. Otherwise all of them are processes on loopback. A
computer that permits namespaces but does not lay the cables is a failure, never a reason for loopback.
"""

from __future__ import annotations

import functools
import subprocess
from pathlib import Path
from typing import Final, Self

from robots import Process, until

ROUTER: Final = "10.99.0.1"
HOST: Final = "10.99.0.{}"
NAMESPACE: Final = ("unshare", "--map-root-user", "--net")
TABLES: Final = ("tcp", "tcp6", "udp", "udp6")
LISTENING: Final = "0A"
"""State of a socket in /proc/net/tcp."""


@functools.cache
def permits_namespaces() -> bool:
    """Return whether this computer permits network namespaces."""
    try:
        return subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode == 0
    except OSError:
        return False


class Host:
    """A computer: its processes have its network and its folder."""

    def __init__(self, folder: Path, number: int, inside: tuple[str, ...]) -> None:
        self.folder, self.number, self.inside = folder, number, inside
        self.processes: list[Process] = []

    def start(self, *command: str, listens: bool = False) -> Process:
        """Start a Python program."""
        process = Process(*command, listens=listens, traced=False, folder=self.folder, inside=self.inside)
        self.processes.append(process)
        return process

    @property
    def address(self) -> str:
        """The address of this computer."""
        return HOST.format(self.number) if self.inside else "127.0.0.1"


class School:
    """The computers, and the cables between them and the router's computer."""

    def __init__(self, folder: Path) -> None:
        self.isolated = permits_namespaces()
        self._folder = folder
        self._namespaces: list[subprocess.Popen[bytes]] = []
        self.hosts: list[Host] = []
        self.router = self._host("router")

    @property
    def address(self) -> str:
        """The router's address."""
        return ROUTER if self.isolated else "127.0.0.1"

    def host(self, name: str) -> Host:
        """Create a computer, and plug its cable in; return it."""
        host = self._host(name)
        if self.isolated:
            cable, own, pid = f"cable{host.number}", HOST.format(host.number), self._namespaces[-1].pid
            self._network(
                self.router,
                f"link add name {cable} type veth peer name eth0 netns {pid}",
                f"addr add {ROUTER} peer {own} dev {cable}",
                f"link set {cable} multicast off up",
            )
            self._network(
                host,
                f"addr add {own} peer {ROUTER} dev eth0",
                "link set eth0 multicast off up",
            )
        return host

    def _host(self, name: str) -> Host:
        folder = self._folder / name
        folder.mkdir()
        inside: tuple[str, ...] = ()
        if self.isolated:  # `cat` keeps the namespace until this process closes the input of `cat`, or ends
            make = (*self.router.inside, "unshare", "--net") if self.hosts else NAMESPACE
            keeper = subprocess.Popen([*make, "cat"], stdin=subprocess.PIPE)
            self._namespaces.append(keeper)
            until(lambda: Path(f"/proc/{keeper.pid}/comm").read_text() == "cat\n", "a namespace")
            inside = ("nsenter", "--preserve-credentials", "--user", "--net", "--target", str(keeper.pid))
        host = Host(folder, len(self.hosts) + 1, inside)
        self.hosts.append(host)
        if self.isolated:
            own = HOST.format(host.number)
            self._network(host, "link set lo up", *([] if self.hosts[1:] else [f"addr add {own} dev lo"]))
        return host

    def _network(self, host: Host, *lines: str) -> None:
        """Change the network of a computer; each line is a command of ip(8)."""
        subprocess.run(
            [*host.inside, "ip", "-batch", "-"], input="\n".join(lines), text=True, check=True, timeout=10
        )

    def close(self) -> None:
        """End all processes and networks."""
        for host in reversed(self.hosts):
            for process in reversed(host.processes):
                process.end()
        for keeper in self._namespaces:
            keeper.communicate(timeout=10)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def sockets(pid: int) -> list[tuple[str, str]]:
    """Return protocol and state of all internet sockets of a process, from /proc."""
    links = [str(path.readlink()) for path in Path(f"/proc/{pid}/fd").iterdir() if path.is_symlink()]
    own = {link.partition("[")[2].rstrip("]") for link in links if link.startswith("socket:")}
    rows = [
        (table, line.split())
        for table in TABLES
        for line in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]
    ]
    return [(table, fields[3]) for table, fields in rows if fields[9] in own]

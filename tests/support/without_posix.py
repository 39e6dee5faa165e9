"""Take away what Python for Windows lacks, and import every module of the packages again: `python without_posix.py`.

It cannot show that a program works on Windows, only that no module asks for what is not there when it is imported.
"""

from __future__ import annotations

import importlib
import os
import pkgutil
import select
import signal
import socket
import sys
import time
from collections.abc import Iterator

PACKAGES = ("beatrix_zenoh", "sim_node", "hw_node", "gui")
PROGRAMS = (".__main__", ".examples.", ".library.", ".legacy.terminal.")
"""Parts of names of modules that do something when they are imported, and of the one that Windows never imports."""
MODULES = ("fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty")
"""Modules of Python that Windows has not."""
LACKING = {
    os: (
        *(
            "chown",
            "fork",
            "forkpty",
            "getegid",
            "geteuid",
            "getgid",
            "getloadavg",
            "getpgid",
            "getpgrp",
            "getpriority",
        ),
        *("getsid", "getuid", "initgroups", "killpg", "mkfifo", "mknod", "nice", "openpty", "posix_spawn"),
        *(
            "register_at_fork",
            "sched_getaffinity",
            "sched_setaffinity",
            "sched_yield",
            "setpgid",
            "setpriority",
            "setsid",
        ),
        *(
            "setuid",
            "statvfs",
            "sync",
            "sysconf",
            "tcgetpgrp",
            "ttyname",
            "uname",
            "wait",
            "wait3",
            "wait4",
            "WNOHANG",
        ),
    ),
    select: ("poll", "epoll", "POLLIN", "POLLHUP"),
    signal: (
        *(
            "SIGALRM",
            "SIGCHLD",
            "SIGCONT",
            "SIGHUP",
            "SIGKILL",
            "SIGPIPE",
            "SIGPROF",
            "SIGQUIT",
            "SIGSTOP",
            "SIGTSTP",
        ),
        *(
            "SIGUSR1",
            "SIGUSR2",
            "SIGWINCH",
            "alarm",
            "pause",
            "pthread_kill",
            "pthread_sigmask",
            "setitimer",
            "sigwait",
        ),
    ),
    socket: ("AF_UNIX", "MSG_DONTWAIT", "SO_REUSEPORT", "TCP_DEFER_ACCEPT", "TCP_USER_TIMEOUT", "socketpair"),
    time: ("tzset",),
}
"""Names of modules that Windows has, but without these."""


def names() -> Iterator[str]:
    """Yield the names of all modules that can be imported without doing something."""
    for package in map(importlib.import_module, PACKAGES):
        yield package.__name__
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not any(part in f"{found.name}." for part in PROGRAMS):
                yield found.name


def hide() -> None:
    """Take away the modules and the names."""
    for module in MODULES:
        sys.modules[module] = None  # type: ignore[assignment]
    for holder, lacking in LACKING.items():
        for name in lacking:
            if hasattr(holder, name):
                delattr(holder, name)


def main() -> None:
    """Import all modules twice: with everything, which also loads the other packages, and as on Windows."""
    found = list(names())
    for name in found:
        importlib.import_module(name)
    for name in [name for name in sys.modules if name.partition(".")[0] in PACKAGES]:
        del sys.modules[name]
    hide()
    sys.platform = "win32"
    for name in found:
        importlib.import_module(name)
    print(len(found), "modules")


if __name__ == "__main__":
    main()

"""Where a pupil's program runs: with temporary home, settings and environment of its own, on Linux also behind bubblewrap.

bubblewrap (`bwrap`) shows it the system and Python read-only, its own folder, its temporary home, and nothing else.
Without it, the program can read and write all that the user can who checks it.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import site
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Final

import beatrix_zenoh
from beatrix_zenoh import account, files
from beatrix_zenoh.account import Account
from beatrix_zenoh.contract.errors import BeatrixError, bad_value
from beatrix_zenoh.lessons.guard import USED
from beatrix_zenoh.lessons.program import Program
from beatrix_zenoh.process_groups import GROUP, NEW_GROUP

GUARD: Final = (sys.executable, "-I", "-S", str(Path(__file__).with_name("guard.py")))
KEPT: Final = (
    *("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "LANG", "LANGUAGE", "TZ", "USER", "LOGNAME", "USERNAME"),
    *("SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "COMSPEC", "PATHEXT", "TEMP", "TMP", "NUMBER_OF_PROCESSORS"),
)
"""Variables of the environment that the program keeps, besides those that begin with LC_."""
HOMES: Final = ("HOME", "USERPROFILE", "APPDATA", "LOCALAPPDATA")
"""Variables that name the folder of a user on Linux, macOS and Windows."""
SYSTEM: Final = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/nix", "/sys")
"""Folders that the program can read."""
LONGEST: Final = 100
"""Largest size (bytes) of the file that the guard writes."""
TRIAL: Final = (
    "from importlib.util import find_spec; exit(not (find_spec('beatrix_zenoh') and find_spec('numpy')))"
)
TRIAL_S: Final = 10.0


def at_home(folder: Path) -> dict[str, str]:
    """Return the variables of a process whose home and settings are in a folder."""
    packages = site.getuserbase()  # those of `pip install --user` would be in the home
    return {**dict.fromkeys((*HOMES, "XDG_CONFIG_HOME"), str(folder)), "PYTHONUSERBASE": packages}


class Sandbox:
    """The surroundings of one program, which finds its files as when the user runs it by hand.

    They are the file that Python runs, its working folder, and a temporary folder with its home.
    """

    def __init__(self, program: Program, temporary: Path) -> None:
        self.program, self.file = program, program.file(temporary)
        self.working = program.folder or Path.cwd()
        self._temporary, self._home = temporary, temporary / "home"
        self._home.mkdir(exist_ok=True)

    def _environment(self, more: Mapping[str, str]) -> dict[str, str]:
        """Return the variables of the program's environment, with some more."""
        kept = {key: text for key, text in os.environ.items() if key in KEPT or key.startswith("LC_")}
        own = {
            **at_home(self._home),
            "PYTHONUNBUFFERED": "1",
            "PYTHONIOENCODING": "utf-8",
            "MPLBACKEND": "Agg",  # `plt.show()` would wait for a window
            "BEATRIX_ACCOUNT": "",
        }
        return kept | own | dict(more)

    def used_s(self) -> float:
        """Return the processor time (s) of the last program that has ended; 0 if it is not known, as on Windows."""
        try:
            return float(files.text(self._home / USED, LONGEST, "text"))
        except (OSError, ValueError, BeatrixError):
            return 0.0

    def start(
        self,
        words: list[str],
        more: Mapping[str, str],
        guard: Sequence[str] = (),
        stderr: int = subprocess.STDOUT,
    ) -> subprocess.Popen[bytes]:
        """Start Python, below a guard, with these arguments and more variables; its input and output are pipes."""
        command = [*guard, sys.executable, *words]
        return subprocess.Popen(
            [*self._bubblewrap(), *command] if bubblewrap_works() else command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            cwd=self.working,
            env=self._environment(more),
            process_group=GROUP,
            creationflags=NEW_GROUP,
        )

    def _bubblewrap(self) -> list[str]:
        private = files.user_folder()
        own = {self.program.path.parent, self._temporary, self.working}
        shown = sorted(str(path) for path in own if not private.is_relative_to(path))
        binds = [word for path in shown for word in ("--bind", path, path)]
        return [*bubblewrap(), *binds, "--dir", str(self.working), "--chdir", str(self.working)]


def bubblewrap() -> list[str]:
    """Return the command before that of a program that sees system and Python read-only, and no file of the user."""
    system = [word for path in SYSTEM for word in ("--ro-bind-try", path, path)]
    python = [word for path in _python() for word in ("--ro-bind-try", path, path)]
    ends = ("--unshare-pid", "--unshare-ipc", "--die-with-parent", "--new-session")
    return ["bwrap", *ends, *system, "--proc", "/proc", "--dev", "/dev", "--tmpfs", "/tmp", *python]  # noqa: S108 - in the sandbox


def _python() -> list[str]:
    """Return the folders of Python and its packages; not the working folder, and none with the user's settings."""
    base, package = Path(sys.base_prefix), Path(beatrix_zenoh.__file__).parent.parent
    packages = [path for path in map(Path, sys.path) if path.is_absolute() and path != Path.cwd()]
    private = files.user_folder()
    found = {Path(sys.prefix), base, base.resolve(), package, *packages}
    return sorted(str(path) for path in found if path.exists() and not private.is_relative_to(path))


@cache
def bubblewrap_works() -> bool:
    """Return whether bubblewrap is installed and may make its namespaces, which some systems and containers forbid."""
    if sys.platform != "linux" or shutil.which("bwrap") is None:
        return False
    command = [*bubblewrap(), sys.executable, "-c", TRIAL]
    try:
        return subprocess.run(command, capture_output=True, timeout=TRIAL_S, check=False).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def refuse_teacher(own: Account | None) -> None:
    """Raise Refused (BAD_VALUE) if the account in use is the teacher's: a pupil's program could read or use it.

    Without one it is refused if the account that `beatrix join` has stored is the teacher's, and can be read.
    """
    stored = account.joined()
    if own is None and stored.is_file() and not bubblewrap_works():
        with contextlib.suppress(BeatrixError):  # an invalid file is no account
            own = account.load(stored)
    if own is not None and own.role == "teacher":
        raise bad_value(
            "The account of this user is the teacher's, and a pupil's program could read it: it runs with the rights of the "
            "user who checks it. Check programs as another user of this computer, or on a seat's computer. On Linux with "
            "bubblewrap, `BEATRIX_ACCOUNT= beatrix lesson check` hides all accounts from the program.",
        )


PREFIX: Final = "beatrix-lesson-"
"""Beginning of the names of these folders, and of those of the simulations of a check."""


@contextlib.contextmanager
def scratch() -> Iterator[Path]:
    """Yield a folder that is deleted at the end of the block."""
    with tempfile.TemporaryDirectory(prefix=PREFIX) as folder:
        yield Path(folder)

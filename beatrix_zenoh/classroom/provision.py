"""Create and update the files of a class: accounts, routers and cards."""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beatrix_zenoh import account, files
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus.credentials import Identity
from beatrix_zenoh.classroom.class_file import Classroom
from beatrix_zenoh.classroom.router_file import ROUTERS, RouterFile, load
from beatrix_zenoh.errors import Refused, WrongUsage

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"
"""Characters of passwords, without those that look alike."""
GROUPS, GROUP = 4, 4
"""Number of groups in a password, and characters in each: 79 bits, too many to guess one from a recorded login."""
MISSING = '`beatrix classroom init` needs {}, which is not installed: pip install ".[classroom]" in the folder of BEATRIX'


@dataclass(frozen=True)
class Made:
    """Result of `init`."""

    accounts: list[Account]
    new: list[str]
    """accounts with a new secret, whose files must be handed out"""
    left: list[str]
    """files of accounts that the class no longer has"""
    moved: bool
    """whether the address or port of the router has changed, so that all files must be handed out again"""


def folder_of(role: str) -> str:
    """Return the name of the folder of the account files of a role."""
    return "robots" if role == "robot" else "seats"


def init(classroom: Classroom, folder: Path) -> Made:
    """Write all files of the class to `folder`; existing accounts keep their credentials.

    Raises:
        Refused: BAD_VALUE, a package is missing, or a file cannot be written.
        WrongUsage: BAD_VALUE, an existing file cannot be read.
    """
    try:
        from beatrix_zenoh.classroom.cards import cards  # noqa: PLC0415  # segno is in an extra
    except ModuleNotFoundError as error:
        raise Refused(Reason.BAD_VALUE, MISSING.format(error.name)) from error
    try:
        for name in ("", "seats", "robots"):
            (folder / name).mkdir(mode=0o700, parents=True, exist_ok=True)
        signer = _Signer(folder, classroom) if classroom.certificates or classroom.standby else None
        made = _accounts(classroom, folder, signer)
        for one in made.accounts:
            files.write_private(folder / folder_of(one.role) / f"{one.name}.toml", one.text())
        passwords = {one.name: one.password for one in made.accounts if one.password}
        for file in _routers(classroom, folder, signer, passwords):
            files.write_private(folder / f"{file.role}.toml", file.text())
        files.write_private(folder / "cards.html", cards(classroom, made.accounts))
    except OSError as error:
        raise Refused(Reason.BAD_VALUE, f"Cannot write the files of the class: {error}.") from error
    return made


class _Signer:
    """Signs certificates with the authority of the class, whose file is needed on the teacher's computer only."""

    def __init__(self, folder: Path, classroom: Classroom) -> None:
        try:
            from beatrix_zenoh.classroom.certificates import Authority, expiry  # noqa: PLC0415  # needs an extra
        except ModuleNotFoundError as error:
            raise Refused(Reason.BAD_VALUE, MISSING.format(error.name)) from error
        path = folder / "authority.pem"
        if path.is_file():
            try:
                self.authority = Authority.read(path.read_text(encoding="utf-8"))
            except ValueError as error:
                raise WrongUsage(Reason.BAD_VALUE, f"{path} cannot be read: {error}.") from error
        else:
            self.authority = Authority.make(classroom.name)
            files.write_private(path, self.authority.text)
        self._expiry = expiry

    def certified(self, account: Account, old: Account | None) -> Account:
        """Return the account with its old certificate, or with a new one if `Authority.signed` rejects it."""
        if old is not None and self.authority.signed(old.certificate):
            own = Identity(self.authority.certificate, old.certificate, old.key)
        else:
            own = self.authority.issue(account.name)
        return msgspec.structs.replace(
            account,
            expires=self._expiry(own.certificate),
            authority=own.authority,
            certificate=own.certificate,
            key=own.key,
        )


def _accounts(classroom: Classroom, folder: Path, signer: _Signer | None) -> Made:
    made: list[Account] = []
    new: list[str] = []
    moved = False
    for name, role in classroom.accounts.items():
        path = folder / folder_of(role) / f"{name}.toml"
        old = account.load(path) if path.is_file() else None
        bare = Account(classroom.name, name, role, classroom.connect)
        if classroom.certificates and signer is not None:
            made.append(signer.certified(bare, old))
        else:
            password = old.password if old is not None else ""
            made.append(msgspec.structs.replace(bare, password=password or _password()))
        moved = moved or (old is not None and old.connect != classroom.connect)
        if old is None or (old.password, old.key) != (made[-1].password, made[-1].key):
            new.append(name)
    present = [path for role in ("seats", "robots") for path in sorted((folder / role).glob("*.toml"))]
    return Made(made, new, [str(path) for path in present if path.stem not in classroom.accounts], moved)


def _routers(
    classroom: Classroom, folder: Path, signer: _Signer | None, passwords: dict[str, str]
) -> list[RouterFile]:
    places = {"router": (classroom.listen, classroom.addresses)}
    if classroom.standby:
        places["standby"] = (classroom.standby_listen, (classroom.standby,))
        if passwords:
            passwords = {**passwords, ROUTERS["standby"]: _link_password(folder)}
    made = []
    for role, (listen, addresses) in places.items():
        identity = None if signer is None else signer.authority.issue(ROUTERS[role], addresses)
        made.append(
            RouterFile(
                class_name=classroom.name,
                role="router" if role == "router" else "standby",
                listen=listen,
                seats=classroom.seats,
                robots=classroom.robots,
                pictures_hz=classroom.pictures_hz,
                link=classroom.link,
                authority=identity.authority if identity else "",
                certificate=identity.certificate if identity else "",
                key=identity.key if identity else "",
                passwords=passwords,
            )
        )
    return made


def _link_password(folder: Path) -> str:
    """Return the password of the second router; an existing password is kept, so that the router's file stays valid."""
    path = folder / "router.toml"
    before = load(path).passwords if path.is_file() else {}
    return before.get(ROUTERS["standby"]) or _password()


def _password() -> str:
    letters = ("".join(secrets.choice(LETTERS) for _ in range(GROUP)) for _ in range(GROUPS))
    return "-".join(letters)

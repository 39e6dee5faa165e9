"""`beatrix classroom init`: makes accounts, the configuration of a router, and cards from a class file."""

from __future__ import annotations

import html
import re
from pathlib import Path

import pytest
from class_router import class_text
from shell import beatrix

from beatrix_zenoh import account, class_file
from beatrix_zenoh.contract.errors import WrongUsage


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "class.toml"
    path.write_text(class_text())
    return path


def files(folder: Path) -> dict[str, str]:
    """Return the text of each account file by its name."""
    return {path.name: path.read_text() for path in folder.glob("*s/*.toml")}


def test_each_account_has_a_file_and_a_card(file: Path) -> None:
    done = beatrix("classroom", "init", str(file))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"Class 8b: 2 seats, 2 robots, in {file.parent / '8b'}\n")
    assert "beatrix router --class" in done.stdout
    folder = file.parent / "8b"
    assert files(folder).keys() == {"teacher.toml", "ana.toml", "ben.toml", "bea1.toml", "bea2.toml"}
    page = (folder / "cards.html").read_text()
    assert re.findall("<h1>(.*?)</h1>", page) == ["teacher", "ana", "ben", "bea1", "bea2"]
    assert page.count("<svg") == 5
    assert html.escape("Ada <Lovelace>") in page
    assert "http" not in page.replace("http://www.w3.org", ""), "nothing is loaded from elsewhere"
    own = account.load(folder / "seats" / "ana.toml")
    assert (own.role, own.robot) == ("student", "ana")
    assert account.parse(own.text(), "text") == own
    assert own.key not in done.stdout


def test_a_second_init_keeps_secrets_and_adds_new_seats(file: Path) -> None:
    assert beatrix("classroom", "init", str(file)).returncode == 0
    folder = file.parent / "8b"
    before = files(folder)
    file.write_text(file.read_text().replace('["ana", "ben"]', '["ana", "zoe"]'))
    assert "has changed" in beatrix("router", "--class", str(file)).stderr
    done = beatrix("classroom", "init", str(file))
    assert "new or changed     teacher, zoe\n" in done.stdout
    assert "ben.toml: the class has no such seat" in done.stderr
    after = files(folder)
    # The account of the teacher lists the seats.
    assert {name for name in after if after[name] != before.get(name)} == {"teacher.toml", "zoe.toml"}
    router = (folder / "router.toml").read_text()
    assert "ben" not in router
    assert "new or changed     none\n" in beatrix("classroom", "init", str(file)).stdout
    assert (folder / "router.toml").read_text() == router, "a router that runs need not restart"


def test_the_error_of_a_router_without_accounts_names_the_command_to_run(file: Path) -> None:
    done = beatrix("router", "--class", str(file))
    assert done.returncode == 2
    assert "beatrix classroom init" in done.stderr
    missing = beatrix("router", "--class", str(file.with_name("clas.toml")))
    assert (missing.returncode, "clas.toml cannot be read" in missing.stderr) == (2, True)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({'["ana", "ben"]': "0"}, ">= 1 - at `$.seats`"),
        ({'["ana", "ben"]': '["ana", "bea1"]'}, "bea1 is used twice"),
        ({'["ana", "ben"]': '["teacher"]'}, "teacher is used twice, or by BEATRIX itself"),
        ({'["ana", "ben"]': '["ana", "pose"]'}, "pose is used twice, or by BEATRIX itself"),
        ({'["ana", "ben"]': '["Zoë"]'}, "[seats] with names of pupils"),
        ({'["ana", "ben"]': '["Ana"]'}, "'ana'"),
        ({'["ana", "ben"]': '["legacy"]'}, "legacy"),
        ({'"127.0.0.1"': '"a b..c"'}, "at `$.addresses[0]`"),
        ({'["127.0.0.1"]': "[]"}, ">= 1 - at `$.addresses`"),
        ({"7447": "70000"}, "<= 65534 - at `$.router.port`"),
        ({'"127.0.0.1"': '"::1"'}, "at `$.addresses[0]`"),
        ({"robots": "robot"}, "robot"),
        ({"teacher =": "teacher"}, "cannot be read"),
        ({"robots =": "robot ="}, "unknown field `robot`"),
    ],
)
def test_the_refusal_of_a_wrong_class_file_names_the_field(
    tmp_path: Path, change: dict[str, str], sentence: str
) -> None:
    text = class_text()
    for old, new in change.items():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "class.toml"
    path.write_text(text)
    with pytest.raises(WrongUsage, match=re.escape(sentence)):
        class_file.read(path)


def test_pupils_may_have_names_in_any_alphabet_which_only_cards_and_the_teacher_have(tmp_path: Path) -> None:
    path = tmp_path / "class.toml"
    without_seats = class_text().replace('seats = ["ana", "ben"]\n', "")
    path.write_text(f'{without_seats}\n[seats]\nzoe = "Zoë Müller"\nli = "李 明"\n', encoding="utf-8")
    assert beatrix("classroom", "init", str(path)).returncode == 0
    folder = tmp_path / "8b"
    teacher = account.load(folder / "seats" / "teacher.toml")
    assert [teacher.shown(seat) for seat in ("zoe", "li", "seat03")] == [
        "Zoë Müller (zoe)",
        "李 明 (li)",
        "seat03",
    ]
    page = (folder / "cards.html").read_text(encoding="utf-8")
    sheets = [re.findall("<h1>(.*?)</h1>", section) for section in page.split("<section>")[1:]]
    assert sheets == [["teacher"], ["Zoë Müller", "李 明"], ["bea1", "bea2"]]
    assert "section + section { break-before: page; }" in page, "each on sheets of its own"
    assert "Student zoe in class 8b" in page
    others = {name: text for name, text in files(folder).items() if name != "teacher.toml"}
    assert not any("Müller" in text for text in (*others.values(), (folder / "router.toml").read_text()))
    path.write_text(path.read_text(encoding="utf-8").replace("Müller", "Maier"), encoding="utf-8")
    assert "new or changed     teacher\n" in beatrix("classroom", "init", str(path)).stdout

"""Files of a user with the name of a module that BEATRIX needs, in the folder of the program or in PYTHONPATH."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from robots import free_endpoint, python, until

from beatrix_zenoh.cli import app
from beatrix_zenoh.doctor import computer
from beatrix_zenoh.processes import Supervisor

PROGRAM = """
from beatrix_zenoh import Robot
Robot("bea1", connect="nowhere")
"""


CLI = ("-P", "-m", "beatrix_zenoh.cli")


@pytest.mark.parametrize("name", ["logging", "zenoh"])
def test_the_error_of_a_program_names_the_file_that_hides_a_module(name: str, tmp_path: Path) -> None:
    (tmp_path / f"{name}.py").touch()
    (tmp_path / "prog.py").write_text(PROGRAM, encoding="utf-8")
    done = python(tmp_path, "prog.py")
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith(f"ImportError: {tmp_path / name}.py hides ")
    assert f" {name}, which BEATRIX needs: rename it" in last


def package(folder: Path, name: str, version: str, tag: str, text: str) -> Path:
    """Write a package as pip does with `--target folder`, and return the folder."""
    info = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir(parents=True)
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nTag: {tag}-linux_x86_64\n", encoding="utf-8")
    (folder / name).mkdir()
    (folder / name / "__init__.py").write_text(text, encoding="utf-8")
    (folder / name / "exceptions.py").touch()  # the real package has it, too: a copy, no file that hides it
    return folder


OTHER = "Error importing numpy: you should not try to import numpy from its source directory"


def test_a_package_that_beatrix_cannot_use_is_named_with_folder_and_version(tmp_path: Path) -> None:
    path = package(tmp_path / "path", "numpy", "1.26.4", "py3-none", f"raise ImportError({OTHER!r})")
    (tmp_path / "prog.py").write_text(PROGRAM, encoding="utf-8")
    expected = f"{path} contains numpy 1.26.4, and BEATRIX needs numpy>=2.0"
    done = python(tmp_path, *CLI, "ls", "--connect", free_endpoint(), PYTHONPATH="path")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert done.stderr.startswith(expected)
    done = python(tmp_path, "prog.py", PYTHONPATH=str(path))
    assert done.stderr.strip().splitlines()[-1].startswith(f"ImportError: {expected}")


def test_doctor_lists_the_files_of_its_folder_that_hide_modules_and_packages_of_another_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = package(tmp_path / "path", "numpy", "2.2.0", "cp310-cp310", "")
    for name in ("path/wasmtime", "logging", "zenoh", "beatrix_zenoh", "test", "os", "mine", "gui/__init__"):
        file = tmp_path / f"{name}.py"
        file.parent.mkdir(exist_ok=True)
        file.touch()
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(path)
    findings = {one.what: one for one in computer.hidden_modules()}
    modules = [f"module {name}" for name in ("beatrix_zenoh", "gui", "logging", "wasmtime", "zenoh")]
    assert [*findings] == [*modules, "package numpy"]
    assert findings["module gui"].found.startswith(f"{tmp_path / 'gui'} hides ")
    assert findings["module logging"].todo.startswith("rename it, for example to my_logging.py")
    assert findings["package numpy"].found.startswith(f"{path} contains numpy 2.2.0 for Python 3.10")
    assert str(path) in findings["package numpy"].todo


def test_a_copy_that_cannot_be_imported_is_named_by_doctor_and_by_the_verb_that_needs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = package(tmp_path / "path", "numpy", "2.2.0", "py3-none", "print 'Python 2'")
    done = python(tmp_path, *CLI, "sim", "--name", "bea1", PYTHONPATH=str(path))
    expected = f"{path / 'numpy'} hides the package numpy, which BEATRIX needs: rename it"
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert done.stderr.startswith(expected)
    monkeypatch.setenv("PYTHONPATH", str(path))
    assert computer.graphics().advice.startswith(expected)


@pytest.mark.parametrize(
    ("name", "verb"),
    [
        ("typer.py", "doctor"),
        ("dataclasses.py", "ls"),
        ("sim_node/__init__.py", "sim --help"),
        ("rerun/__init__.py", "export x.rrd x.csv"),
    ],
)
def test_the_command_line_names_a_hiding_file_or_package_in_one_line(
    name: str, verb: str, tmp_path: Path
) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).touch()
    (tmp_path / "x.rrd").write_text("data", encoding="utf-8")
    done = python(tmp_path, *CLI, *verb.split(), PYTHONPATH=".")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    hiding = tmp_path / name.removesuffix("/__init__.py")
    assert done.stderr.startswith(f"{hiding} hides ")
    assert f" {hiding.stem}, which BEATRIX needs: rename it" in done.stderr


def test_a_child_of_up_executes_no_file_of_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "gui.py").write_text("open('executed', 'w')\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with Supervisor() as supervisor:
        child = supervisor.start("gui", "gui", "--help")
        until(lambda: child.code is not None, "the child ends")
        assert (child.code, (tmp_path / "executed").exists()) == (0, False), child.lines()


def test_a_missing_dependency_is_reported_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(_words: object) -> None:
        raise ModuleNotFoundError("No module named 'msgpack'", name="msgpack")

    monkeypatch.setattr("beatrix_zenoh.cli.verbs.application", broken)
    assert app.run(["doctor"]) == 1
    install = f'Run `{sys.executable} -m pip install "beatrix-zenoh[cli]"`.'
    said = f"The command line needs msgpack, which is not installed. {install}\n"
    assert capsys.readouterr().err == said

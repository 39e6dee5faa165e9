"""Write every file that is generated from schemas/*.toml; with `--check` only compare.

python schemas/generate.py          write
python schemas/generate.py --check  exit 1 and name the files that differ
python schemas/generate.py --robot fast.toml --header build/contract.h
                                    only the firmware's header, for a robot with other values
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import emit_board
import emit_cpp
import emit_python
import emit_reference
import emit_vectors
from contract import ROOT, load


def formatted(path: str, text: str) -> str:
    """Return the text of a file; Python is formatted by ruff, as the checked-in files are."""
    if not path.endswith(".py"):
        return text
    command = [sys.executable, "-m", "ruff", "format", "--stdin-filename", str(ROOT / path), "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True, cwd=ROOT).stdout


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="only compare; write nothing")
    parser.add_argument("--robot", type=Path, help="values of another robot, for --header")
    parser.add_argument("--header", type=Path, help="write only this C++ header")
    arguments = parser.parse_args()
    if arguments.header:
        try:
            header = emit_cpp.header(load(arguments.robot))
        except (OSError, ValueError, OverflowError, RecursionError) as error:
            parser.error(f"{arguments.robot}: {error}")
        arguments.header.write_text(header, encoding="utf-8")
        return 0
    check = arguments.check
    try:
        contract = load()
    except (ValueError, OverflowError) as error:
        parser.error(f"schemas: {error}")
    emitters = (emit_python, emit_board, emit_cpp, emit_reference, emit_vectors)
    wanted = {
        path: formatted(path, text) for emitter in emitters for path, text in emitter.files(contract).items()
    }
    stale = [
        path
        for path, text in wanted.items()
        if not (ROOT / path).exists() or (ROOT / path).read_text(encoding="utf-8") != text
    ]
    if check:
        for path in stale:
            print(f"{path} differs from schemas/*.toml: run `make generate`")
        return 1 if stale else 0
    for path in stale:
        (ROOT / path).parent.mkdir(parents=True, exist_ok=True)
        (ROOT / path).write_text(wanted[path], encoding="utf-8")
        print("wrote", path)
    return 0


if __name__ == "__main__":
    sys.exit(main())

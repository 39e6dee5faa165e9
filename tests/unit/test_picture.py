from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def probed(environment: dict[str, str], before: str = "") -> str:
    """Return the OpenGL backend in a new process that has run the code `before`."""
    command = [sys.executable, "-c", f"{before}from sim_node.gl import backend; print(backend())"]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=50,
        check=True,
    )
    return done.stdout.strip()


def test_without_opengl_libraries_physics_works_and_there_is_no_backend(tmp_path: Path) -> None:
    """With MUJOCO_GL=egl and without the library of EGL, even `import mujoco` fails."""
    (tmp_path / "OpenGL").mkdir()
    (tmp_path / "OpenGL" / "__init__.py").write_text("raise AttributeError('no library of this name')")
    absent = {"PYTHONPATH": str(tmp_path), "MUJOCO_GL": "egl"}
    bare = [sys.executable, "-c", "import mujoco"]
    assert subprocess.run(bare, env={**os.environ, **absent}, capture_output=True, check=False).returncode
    assert (
        probed(absent, "from sim_node.plant import Plant; Plant().step((0, 0, 0), drivers_on=True); ")
        == "None"
    )

"""Fixtures and paths that the tests share."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import geodesics as gd

REPOSITORY = Path(__file__).resolve().parents[3]


def shared():
    """The folder of shared files: $GEOBENCH_SHARED, or `shared` beside the repository."""
    return Path(os.environ.get("GEOBENCH_SHARED", REPOSITORY.parent / "shared"))


def model(name):
    """The path of a shared model. The test is skipped if the file does not exist."""
    path = shared() / "models" / name
    if not path.exists():
        pytest.skip(f"no {path}")
    return path


@pytest.fixture(scope="session")
def command():
    """A function that runs the program $GEOBENCH, or the debug build of the workspace."""
    program = os.environ.get("GEOBENCH")
    if program is None:
        target = os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target")
        program = Path(target) / "debug" / "geobench"
        if not program.exists():
            pytest.skip(f"no {program}; build it with cargo build, or set GEOBENCH")

    def run(*arguments, cwd):
        done = subprocess.run(
            [program, *arguments], cwd=cwd, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def square():
    """A unit square of two triangles, and an isolated vertex."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]], dtype=float)
    return gd.Mesh(vertices, np.array([[0, 1, 2], [0, 2, 3]]))


@pytest.fixture(scope="session")
def torus():
    return gd.generate("torus,faces=3000,bump=0.1,seed=7")

"""The package: its stubs, docstrings and version, and the code of its documentation page."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import geodesics as gd
from conftest import REPOSITORY, shared

PAGE = REPOSITORY / "docs" / "python.md"


def test_the_stubs_are_those_of_the_package(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "geodesics", "--ignore-missing-stub"],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_users_are_type_checked(tmp_path):
    good = "import geodesics as gd\nd = gd.generate('holes').distance([0, gd.vertex(3)], radius=1.0)\n"
    path = tmp_path / "user.py"
    for text, status in [(good, 0), (good + "gd.Solver(3)\n", 1), (good + "d.nothing\n", 1)]:
        path.write_text(text)
        done = subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", str(path)],
            capture_output=True,
            text=True,
            check=False,
            cwd=tmp_path,
        )
        assert done.returncode == status, done.stdout + done.stderr


def test_everything_public_is_documented():
    for name in gd.__all__:
        if name == "__version__":
            continue
        item = getattr(gd, name)
        assert item.__doc__, name
        if isinstance(item, type):
            for member, value in vars(item).items():
                if not member.startswith("_") and not isinstance(value, (str, int)):
                    assert getattr(value, "__doc__", None), f"{name}.{member}"


def test_the_versions_are_in_step():
    workspace = (REPOSITORY / "Cargo.toml").read_text()
    version = re.search(r'\[workspace\.package\]\nversion = "(.*?)"', workspace).group(1)
    assert gd.__version__ == version
    for key in ["rust-version", "edition", "license"]:
        line = re.search(rf'^{key} = ".*"$', workspace, re.MULTILINE).group(0)
        assert line in (REPOSITORY / "crates/python/Cargo.toml").read_text()


def recipes():
    """The code of each section of the documentation page."""
    parts = re.split(r"^## ", PAGE.read_text(), flags=re.MULTILINE)
    for part in parts:
        code = re.findall(r"^```python\n(.*?)^```", part, re.MULTILINE | re.DOTALL)
        if code:
            yield pytest.param("\n".join(code), id=part.splitlines()[0])


@pytest.mark.parametrize("code", recipes())
def test_the_page_runs(code, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    scan = shared() / "models" / "stanford-bunny.obj"
    if scan.exists():
        Path("bunny.obj").symlink_to(scan)
    else:
        gd.generate("torus,faces=5000,bump=0.1").write("bunny.obj")
    exec(compile(code, str(PAGE), "exec"), {})
    for picture in re.findall(r'savefig\("(.*?)"', code):
        assert Path(picture).stat().st_size > 10_000


def documented():
    """The public names and members that a user calls, with their docstrings."""
    for name in gd.__all__:
        item = getattr(gd, name)
        if name == "__version__" or isinstance(item, type) and issubclass(item, (Exception, Warning)):
            continue
        yield name, item
        if isinstance(item, type):
            for member, value in vars(item).items():
                if not member.startswith("_") and callable(value) and member not in ("count", "index"):
                    # A static method shows its docstring through the class.
                    yield f"{name}.{member}", getattr(item, member)


@pytest.mark.parametrize(("name", "item"), documented())
def test_every_docstring_has_an_example_that_runs(name, item):
    import doctest

    examples = doctest.DocTestParser().get_doctest(item.__doc__ or "", {}, name, None, 0)
    assert examples.examples, name
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    assert doctest.DocTestRunner(optionflags=flags).run(examples).failed == 0


def test_doctests():
    import doctest

    assert doctest.testmod(gd).failed == 0


def test_the_project_follows_scientific_python():
    pytest.importorskip("repo_review")
    done = subprocess.run(
        [sys.executable, "-m", "repo_review", str(REPOSITORY / "crates/python"), "--format", "json"],
        capture_output=True,
        text=True,
        check=False,
    )
    checks = json.loads(done.stdout)["checks"]
    failed = [name for name, check in checks.items() if check["result"] is False]
    assert checks["PP002"]["result"] and not failed, failed

"""What is built and installed: one import name, complete, and working away from the clone."""

import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib import metadata
from pathlib import Path

import pytest

from eccentric.model import load_model
from eccentric.version import __version__

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PIP = (sys.executable, "-m", "pip")
SCRIPTS = sorted((ROOT / "derivations").glob("*.py"))


def _run(*command: str | Path, cwd: Path, **environment: str) -> str:
    """Run a command to its end and return what it printed; its failure is the test's."""
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd, env=os.environ | environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def _build(source: Path, out: Path) -> tuple[Path, Path]:
    """Build the source distribution of a folder, and the wheel from that; return the paths of both."""
    (requirement,) = PROJECT["build-system"]["requires"]
    found = f"setuptools=={metadata.version('setuptools')}"
    if found != requirement:
        pytest.skip(f"the build backend is {requirement}, which `make test` installs; found {found}")
    hook = "import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])"
    _run(sys.executable, "-c", hook, out, cwd=source)
    (sdist,) = out.glob("*.tar.gz")
    _run(*PIP, "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", out, sdist, cwd=out)
    (wheel,) = out.glob("*.whl")
    return sdist, wheel


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the project without what git ignores, so that builds leave nothing behind here."""
    target = tmp_path_factory.mktemp("clone") / "eccentric"
    ignored = shutil.ignore_patterns(
        ".git", ".venv", "build", "dist", "*.egg-info", "__pycache__", ".*_cache"
    )
    shutil.copytree(ROOT, target, ignore=ignored)
    return target


@pytest.fixture(scope="module")
def built(clone: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return the source distribution of the toolkit and the wheel built from it."""
    return _build(clone, tmp_path_factory.mktemp("dist"))


@pytest.fixture(scope="module")
def site(built: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the wheel installed in it; the dependencies stay where they are."""
    target = tmp_path_factory.mktemp("site")
    _run(*PIP, "install", "--quiet", "--no-deps", "--target", target, built[1], cwd=target)
    return target


def test_every_package_and_what_it_holds_besides_modules_is_listed_once() -> None:
    """What pyproject.toml lists is what the clone has: packages, stubs, templates."""
    tools, root = PROJECT["tool"]["setuptools"], ROOT / "eccentric"
    packages = {path.parent.relative_to(ROOT) for path in root.rglob("__init__.py")}
    stubs = {path.parent.relative_to(ROOT) for path in root.rglob("*.pyi")}
    listed = [name for name, files in tools["package-data"].items() if "__init__.pyi" in files]
    templates = {path.parent.parent for path in (ROOT / "templates").rglob("*.jinja")}

    expected = [*(".".join(path.parts) for path in packages), "eccentric.derivations", "eccentric.templates"]
    assert sorted(expected) == sorted(tools["packages"])
    assert sorted(".".join(path.parts) for path in stubs) == sorted(listed)
    assert {ROOT / "templates"} == templates


@pytest.mark.slow
def test_the_wheel_holds_the_toolkit_and_no_other_package(built: tuple[Path, Path]) -> None:
    """Every module, derivation and template, also through the source archive, below one name."""
    sources = [path for path in (ROOT / "eccentric").rglob("*.py*") if path.suffix != ".pyc"]
    expected = {
        *(path.relative_to(ROOT).as_posix() for path in sources),
        *(f"eccentric/derivations/{path.name}" for path in SCRIPTS),
        *(f"eccentric/{path.relative_to(ROOT)}" for path in (ROOT / "templates").rglob("*.jinja")),
        "eccentric/py.typed",
    }

    with zipfile.ZipFile(built[1]) as wheel:
        assert expected == {name for name in wheel.namelist() if ".dist-info/" not in name}


@pytest.mark.slow
def test_the_source_archive_can_be_tested(built: tuple[Path, Path]) -> None:
    """The source distribution holds what `make test` reads."""
    with tarfile.open(built[0]) as archive:
        parts = {member.split("/")[1] for member in archive.getnames() if "/" in member}

    assert {"tests", "generated", "examples", "Makefile", "constraints.txt", "LICENSE"} <= parts


@pytest.mark.slow
def test_an_installed_copy_works_anywhere(site: Path, tmp_path: Path) -> None:
    """Away from the clone the installed command finds its own derivations and templates."""
    where = "from eccentric.core import folder; print(folder('derivations'), folder('templates'))"

    places = _run(sys.executable, "-c", where, cwd=tmp_path, PYTHONPATH=str(site))
    audit = _run(sys.executable, "-m", "eccentric", "audit", cwd=tmp_path, PYTHONPATH=str(site))

    assert f"{site}/eccentric/derivations {site}/eccentric/templates\n" == places
    assert "Table 1" in audit
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_generated_is_a_distribution_of_its_own(clone: Path, tmp_path: Path) -> None:
    """`pip install ./generated` gives the emitted modules with nothing but NumPy to depend on."""
    _, wheel = _build(clone / "generated", tmp_path)

    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        (path,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        required = [
            line for line in archive.read(path).decode().splitlines() if line.startswith("Requires-Dist")
        ]
    expected = {
        f"eccentric_generated/{path.name}"
        for path in (ROOT / "generated").iterdir()
        if path.suffix in {".py", ".h", ".c"} or path.name == "py.typed"
    }
    assert expected == {name for name in names if ".dist-info/" not in name}
    assert ["Requires-Dist: numpy>=2.0"] == required


def test_every_extra_is_pinned() -> None:
    """The constraints name exactly one version of every direct dependency, and no place to get it from."""
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").split("\n")
    pins = [line.split("==")[0] for line in lines if line and not line.startswith("#")]
    extras = PROJECT["project"]["optional-dependencies"].values()
    direct = {
        requirement.split(">")[0].split("=")[0].split("[")[0]
        for requirement in [
            *PROJECT["project"]["dependencies"],
            *(name for extra in extras for name in extra),
        ]
    }

    assert len(set(pins)) == len(pins)
    assert direct - {"eccentric"} <= set(pins)
    assert [line for line in lines if "/" in line] == []


@pytest.mark.parametrize("name", [path.stem for path in SCRIPTS])
def test_every_derivation_loads_and_hides_no_standard_module(name: str) -> None:
    """It defines the model of its name. Run by its path, a script is first on the import path."""
    assert name == load_model(name).name
    assert name not in sys.stdlib_module_names


def test_the_citation_has_the_version() -> None:
    """CITATION.cff, the changelog and the emitted package name the version that is built."""
    names = {
        "CITATION.cff": f"version: {__version__}\n",
        "CHANGELOG.md": f"## {__version__}\n",
        "generated/pyproject.toml": f'version = "{__version__}"\n',
    }
    for name, line in names.items():
        assert line in (ROOT / name).read_text(encoding="utf-8"), name

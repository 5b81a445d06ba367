"""Locations of the derivations and the templates: inside an installed package, or beside it in a clone."""

from pathlib import Path

from eccentric.errors import InputError

__all__ = ["derivation", "folder"]


def folder(name: str) -> Path:
    """Return the folder of the scripts or templates that belong to this copy of the package.

    Args:
        name: `derivations` or `templates`.

    Returns:
        The folder in the package (an installed wheel), else the one beside it (a clone).

    Raises:
        InputError: neither exists, the installation is incomplete.
    """
    package = Path(__file__).resolve().parent
    inside, beside = package / name, package.parent / name
    if inside.is_dir():
        return inside
    # An installed package is in site-packages, where a `templates` folder would belong to another project.
    if beside.is_dir() and (package.parent / "pyproject.toml").is_file():
        return beside
    raise InputError(f"{name}: required a folder {inside} or, in a clone, {beside}; received neither")


def derivation(name_or_path: str | Path) -> Path:
    """Return the path of a script: given by its path, which ends in `.py`, or by the name of a bundled one.

    The file need not exist.
    """
    path = Path(name_or_path)
    return (path if path.suffix == ".py" else folder("derivations") / f"{name_or_path}.py").resolve()

"""Where the derivations and the templates are: inside an installed package, or beside it in a clone."""

from pathlib import Path

from eccentric.errors import InputError

__all__ = ["folder"]


def folder(name: str) -> Path:
    """Return the folder of the scripts or templates that belong to this copy of the package.

    Args:
        name: `derivations` or `templates`.

    Returns:
        The folder in the package (an installed wheel), else the one beside it (a clone).

    Raises:
        InputError: neither is there, the installation is incomplete.
    """
    package = Path(__file__).resolve().parent
    inside, beside = package / name, package.parent / name
    if inside.is_dir():
        return inside
    # Beside an installed package is site-packages, where a `templates` folder would be someone else's.
    if beside.is_dir() and (package.parent / "pyproject.toml").is_file():
        return beside
    raise InputError(f"{name}: required a folder {inside} or, in a clone, {beside}; received neither")

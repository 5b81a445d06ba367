"""Names of a package that are imported when they are first used: SymPy and SciPy take seconds to import.

The package's `__init__.pyi`, which type checkers read, lists them; it is the only list.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:  # as in `typing`, which takes longer to import than this file
    from collections.abc import Callable


def lazy_names(package: str, file: str) -> "tuple[Callable[[str], object], Callable[[], list[str]]]":
    """`__getattr__` and `__dir__` of a package.

    Args:
        package, file: its `__name__` and `__file__`. Each line `from MODULE import NAME as NAME` of the
            `__init__.pyi` beside the file is a name and where it comes from.
    """
    homes = dict[str, str]()

    def read() -> dict[str, str]:
        if not homes:
            from pathlib import Path

            lines = Path(file).with_name("__init__.pyi").read_text(encoding="utf-8").splitlines()
            words = [line.split() for line in lines if line.startswith("from ")]
            homes.update({name: module for _, module, _, _, _, name, *_ in words})
        return homes

    def get(name: str) -> object:
        if name == "__all__":
            return sorted(read())
        if name not in read():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        import sys
        from importlib import import_module

        found = getattr(import_module(read()[name]), name)
        setattr(sys.modules[package], name, found)
        return found

    return get, lambda: sorted(read())

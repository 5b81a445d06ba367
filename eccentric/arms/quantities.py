"""Quantities of an arm file: a text with a unit, or a number under a key that ends in the SI unit."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from eccentric.arms.limits import LARGEST, LARGEST_ANGLE
from eccentric.entries import read_number, read_table, refuse_unknown
from eccentric.errors import InputError
from eccentric.logs import parse_value

INERTIA = ("xx", "xy", "xz", "yy", "yz", "zz")
"""The entries of a symmetric tensor by name."""

_PER_ANGLE = re.compile(r"[a-z]\s*/")
_RATIO = re.compile(r"\d+/\d+")
"""Kept as it is: 1/9 is exact."""


@dataclass(frozen=True)
class FileQuantity:
    """A quantity of an arm file.

    Attributes:
        key: for texts with a unit, `mass = "2 kg"`.
        unit: SI unit; "1" for a pure number, which is written as such or as a ratio, "1/50".
        suffix: of the key for plain numbers, `mass_kg = 2`; "" if they have no other key.
    """

    key: str
    unit: str
    suffix: str = ""

    @property
    def plain_key(self) -> str:
        """The key for plain numbers in SI."""
        return f"{self.key}_{self.suffix}" if self.suffix else self.key

    @property
    def keys(self) -> tuple[str, ...]:
        """Both keys, one if they are the same."""
        return tuple(dict.fromkeys((self.key, self.plain_key)))

    def scalar(self, table: Mapping[str, Any], where: str, default: float | None = 0.0) -> Any:
        """Return a number in SI; a ratio such as "1/9" as the text that it is, to be kept exact.

        Raises InputError: there is none and no default, it is no number, or it has another unit.
        """
        return self._read(table, where, self._number, default)

    def vector(self, table: Mapping[str, Any], where: str, default: Any = (0.0, 0.0, 0.0)) -> Any:
        """Return three numbers in SI, from a list of three; InputError as for a scalar."""
        return self._read(table, where, self._three, default)

    def rows(self, table: Mapping[str, Any], where: str, default: Any) -> Any:
        """Return a matrix in SI, from three rows of three; InputError as for a scalar."""
        return self._read(table, where, self._rows, default)

    def tensor(self, table: Mapping[str, Any], where: str) -> Any:
        """Return a symmetric matrix in SI, from a table by `INERTIA` or rows; InputError as for a scalar."""
        return self._read(table, where, self._tensor, [[0.0] * 3] * 3)

    def _read(
        self, table: Mapping[str, Any], where: str, read: Callable[[Any, str, str], Any], default: Any
    ) -> Any:
        given = [key for key in self.keys if key in table]
        if len(given) == 2:
            raise InputError(f"{where}: {self.key} is required only once, received {' and '.join(given)}")
        if not given:
            if default is None:
                raise InputError(f"{where}: {self.key} is required, received none")
            return default
        return read(table[given[0]], given[0], f"{where}: {given[0]}")

    def _number(self, value: Any, key: str, where: str) -> Any:
        if isinstance(value, str):
            if key != self.key:
                raise InputError(f"{where}: a number in {self.unit} is required, received {value!r}")
            if self.unit == "m/rad" and not _PER_ANGLE.search(value):
                raise InputError(f"{where}: a unit is required (m/rad, mm/rev), received {value!r}")
            number = parse_value(value, self.unit, where)
            if (
                self.unit != "rad"
            ):  # 0.6 g is 0.0006 kg, not 0.0006000000000000001; right angles keep all digits
                number = float(f"{number:.15g}")
        elif key == self.plain_key or (value == 0 and not isinstance(value, bool)):  # 0 is 0 in every unit
            number = read_number(value, where)
            if self.unit == "rad" and abs(number) > LARGEST_ANGLE:
                hint = f'did you mean "{value:g} deg" under {self.key}?'
                raise InputError(
                    f"{where}: an angle in rad, at most a turn, is required, received {value!r}; {hint}"
                )
        else:
            raise InputError(
                f'{where}: a text with a unit is required, as in "0.1 {self.unit}", received {value!r}'
            )
        if not abs(number) <= LARGEST:
            raise InputError(f"{where}: a size of at most {LARGEST:g} is required, received {value!r}")
        return value if isinstance(value, str) and _RATIO.fullmatch(value) else number

    def _three(self, value: Any, key: str, where: str) -> Any:
        if not isinstance(value, list) or len(value) != 3:
            raise InputError(f"{where}: a list of three, [x, y, z], is required, received {value!r}")
        return [self._number(entry, key, where) for entry in value]

    def _rows(self, value: Any, key: str, where: str) -> Any:
        if not isinstance(value, list) or len(value) != 3:
            raise InputError(f"{where}: three rows of three numbers are required, received {value!r}")
        return [self._three(row, key, where) for row in value]

    def _tensor(self, value: Any, key: str, where: str) -> Any:
        if isinstance(value, list):
            return self._rows(value, key, where)
        table = read_table(value, where)
        refuse_unknown(table, INERTIA, where)
        entry = {
            name: self._number(table[name], key, f"{where}: {name}") if name in table else 0.0
            for name in INERTIA
        }
        return [[entry["".join(sorted(row + column))] for column in "xyz"] for row in "xyz"]

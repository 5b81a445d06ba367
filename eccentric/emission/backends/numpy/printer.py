"""NumPy as a dialect of Python."""

from __future__ import annotations

from eccentric.emission.backends.numpy.pairs import pair_text
from eccentric.emission.backends.python.dialect import ON_PARAMETERS, Dialect, on_samples
from eccentric.emission.backends.python.lines import WIDTH, broken


def _broken(line: str) -> list[str]:
    """The line in formatter style: a choice that is too long has a line for each part."""
    target, _, value = line.partition(" = ")
    if len(line) <= WIDTH or " if " not in value:
        return broken(f"{target} = ", value)
    first, _, rest = value.partition(" if ")
    condition, _, other = rest.partition(" else ")
    if len(value) <= WIDTH - 4:
        return [f"{target} = (", f"    {value}", ")"]
    return [f"{target} = (", f"    {first}", f"    if {condition}", f"    else {other}", ")"]


DIALECT = Dialect(
    kernel=on_samples("np")
    | {
        "sqrt": "np.sqrt({0})",
        "sine_ratio": "runtime.sine_ratio({0}, c)",
        "cosine": "runtime.cosine({0}, c)",
    },
    prepare=ON_PARAMETERS | {name: f"math.{name}({{0}})" for name in ("sqrt", "sin", "cos", "exp")},
    where="np.where({0}, {1}, {2})",
    choice="{1} if {0} else {2}",
    decorator="_model.function",
    missing="math.nan",
    pair=pair_text,
    broken=_broken,
    single=True,
)

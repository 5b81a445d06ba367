"""Designs whose every fit is known in closed form: orthogonal columns, the same in each block.

Each of 128 blocks holds the 16 columns of a Hadamard matrix, entries 1 and -1. A target is a sum of them. A
fit takes out the columns that it has, in sample and in cross-validation alike, and leaves N times the sum of
the squared amplitudes of all others.
"""

from collections.abc import Callable, Mapping

import numpy as np
from scipy.linalg import hadamard

from eccentric.diagnosis.search.attribution import Search
from eccentric.diagnosis.search.candidate import Candidate
from eccentric.diagnosis.search.screen import Screen
from eccentric.effects import Evidence, Shape
from eccentric.identification import BalanceDesign, Coefficient
from eccentric.signals import Rows

Array = np.ndarray
BLOCKS, SIZE = 128, 16
N = BLOCKS * SIZE
COLUMNS = np.tile(hadamard(SIZE), (BLOCKS, 1)).astype(float)
BASE, NOISE = 0, 1
"""Columns of the base, and of what no candidate holds; the second one changes its sign from row to row."""


def mixed(amplitudes: Mapping[int, float]) -> Array:
    """A sum of columns (N,), column -> amplitude."""
    return np.asarray(sum(a * COLUMNS[:, k] for k, a in amplitudes.items()), dtype=float)


def design(
    amplitudes: Mapping[int, float],
    scale: float = 1e-3,
    independent: bool = True,
    also: Array | float = 0.0,
) -> BalanceDesign:
    """A balance with column 0 as its base; the noise has amplitude 1 if not given, `also` is added."""
    every = np.ones(N, dtype=bool)
    rows = Rows(
        t=np.arange(N, dtype=float),
        run=np.zeros(N, dtype=int),
        block=np.repeat(np.arange(BLOCKS), SIZE),
        train=every,
        score=~every,
        weights=np.ones(N),
        description="rows",
        independent=independent,
    )
    base = COLUMNS[:, [BASE]]
    target = mixed({NOISE: 1.0, **amplitudes}) + also
    return BalanceDesign(
        (Coefficient("C", "friction", "N m"),),
        target,
        base,
        every,
        rows.weights,
        name="mechanical",
        rows=rows,
        scale=scale,
        samples=base,
    )


def candidate(
    family: str,
    *columns: Mapping[int, float],
    member: str = "",
    shapes: tuple[Shape, ...] = (),
    of: Callable[[dict[str, float]], Array] | None = None,
    lower: tuple[float, ...] = (-np.inf,),
    special_of: tuple[str, ...] = (),
    repeats: bool = False,
    second_order: tuple[str, ...] = (),
    ridge: float = 0.0,
    balance: str = "mechanical",
) -> Candidate:
    """A candidate with these columns, or with those that `of` makes of its shapes."""
    fixed = np.column_stack([mixed(c) for c in columns]) if columns else np.empty((N, 0))
    return Candidate(
        id=f"{family}[{member}]" if member else family,
        family=family,
        balance=balance,
        evidence=Evidence(
            (f"of_{family}",), special_of=special_of, repeats=repeats, second_order=second_order
        ),
        columns=of or (lambda _: fixed),
        shapes=shapes,
        lower=lower,
        ridge=ridge,
    )


def search(
    amplitudes: Mapping[int, float],
    *candidates: Candidate,
    smooth: tuple[Candidate, ...] = (),
    ruled_out: tuple[Candidate, ...] = (),
    floor: float = 0.0,
    scale: float = 1e-3,
    independent: bool = True,
) -> Search:
    """A search that has run; `floor`: RMS of a row that the sensors explain."""
    balance = design(amplitudes, scale, independent)
    screen = Screen(balance, candidates, floor)
    base = screen.fit([])
    found = Search(screen, Screen(balance, smooth), base, base, ruled_out=Screen(balance, ruled_out))
    found.run()
    return found


def adopted(found: Search) -> list[str]:
    """Ids of what a search adopted."""
    return [variant.candidate.id for variant in found.best.variants]

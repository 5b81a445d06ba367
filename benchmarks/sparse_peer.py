"""Sparse regression of residuals by PySINDy, in the environment of the peers.

Run by benchmarks/sparse_columns.py: python benchmarks/sparse_peer.py FOLDER     (with the .npz files that it wrote)
Sequentially thresholded least squares. Of the thresholds that predict every fifth of the blocks nearly best after
a fit on the others, the largest; leaving all out is one of them. Families rank by what the error grows without them.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np

THRESHOLDS = (0.03, 0.1, 0.2, 0.4, 0.7)
STRIDE = 4  # the rows have passed 25 Hz and follow each other in 4 ms
BLOCK = 200
NEARLY = 1.05


def sparse(columns: np.ndarray, target: np.ndarray, threshold: float) -> np.ndarray:
    """Coefficients of PySINDy's fit."""
    import pysindy as ps  # pyright: ignore[reportMissingImports]

    model = ps.SINDy(
        optimizer=ps.STLSQ(threshold=threshold, alpha=1e-3), feature_library=ps.IdentityLibrary()
    )
    model.fit(columns, t=1.0, x_dot=target[:, None])
    return np.asarray(model.coefficients())[0]


def balance(log: Any, name: str) -> tuple[float, dict[str, float]]:
    """Held-out RMSE of the residual after the fit [N m], and family -> what its loss costs [(N m)^2]."""
    train, score = log["train"], log["score"]
    columns, base, target = log[f"{name}_columns"], log[f"{name}_base"], log[f"{name}_residual"]
    # The part of a column in the span of the paper's own is theirs, as if they were fitted jointly.
    joined = np.column_stack([columns, target])
    joined = joined - base @ np.linalg.lstsq(base[train], joined[train], rcond=None)[0]
    columns, target = joined[:, :-1], joined[:, -1]
    size, scale = np.sqrt(np.mean(columns[train] ** 2, axis=0)), np.sqrt(np.mean(target[train] ** 2))
    before = np.sqrt(np.mean(log[f"{name}_columns"][train] ** 2, axis=0))
    kept = size > 1e-3 * before
    columns, families = columns[:, kept] / size[kept], log[f"{name}_families"][kept]
    few, goal = columns[train][::STRIDE], target[train][::STRIDE] / scale
    aside = np.arange(len(goal)) // BLOCK % 5 == 2
    errors = {float("inf"): float(np.mean(goal[aside] ** 2))}
    for one in THRESHOLDS:
        left = goal[aside] - few[aside] @ sparse(few[~aside], goal[~aside], one)
        errors[one] = float(np.mean(left**2))
    threshold = max(one for one, error in errors.items() if error <= NEARLY * min(errors.values()))
    found = sparse(few, goal, threshold) if np.isfinite(threshold) else np.zeros(len(families))
    parts = {}
    for family in dict.fromkeys(families[found != 0.0]):
        others = few[:, (found != 0.0) & (families != family)]
        left = goal - others @ np.linalg.lstsq(others, goal, rcond=None)[0]
        parts[str(family)] = float(scale**2 * (np.mean(left**2) - np.mean((goal - few @ found) ** 2)))
    return float(np.sqrt(np.mean((target - scale * columns @ found)[score] ** 2))), parts


def main(folder: Path) -> None:
    """Print the answers for all logs of the folder as JSON."""
    warnings.simplefilter("ignore")  # that a threshold leaves nothing over is one of the answers
    answers = {}
    for path in sorted(folder.glob("*.npz")):
        log, parts, rmse = np.load(path), {}, {}
        for name in ("mechanical", "electrical"):
            if f"{name}_residual" in log:
                rmse[name], own = balance(log, name)
                parts |= own
        answers[path.stem] = {"ranked": sorted(parts, key=lambda f: -parts[f]), "rmse": rmse}
    print(json.dumps(answers))


if __name__ == "__main__":
    main(Path(sys.argv[1]))

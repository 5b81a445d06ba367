"""Sparse regression of residuals by PySINDy, in the environment of the peers.

Run by benchmarks/sparse.py: python benchmarks/sparse_peer.py FOLDER     (with the .npz files that it wrote)
Sequentially thresholded least squares; the threshold is the one that predicts every fifth of the blocks best
after a fit on the others, and leaving all out is one of the choices.
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


def sparse(columns: np.ndarray, target: np.ndarray, threshold: float) -> np.ndarray:
    """Coefficients of PySINDy's fit."""
    import pysindy as ps  # pyright: ignore[reportMissingImports]

    model = ps.SINDy(
        optimizer=ps.STLSQ(threshold=threshold, alpha=1e-3), feature_library=ps.IdentityLibrary()
    )
    model.fit(columns, t=1.0, x_dot=target[:, None])
    return np.asarray(model.coefficients())[0]


def balance(log: Any, name: str) -> tuple[float, dict[str, float]]:
    """Held-out RMSE of the residual after the fit [N m], and family -> RMS of its part [N m]."""
    train, score = log["train"], log["score"]
    columns, base, target = log[f"{name}_columns"], log[f"{name}_base"], log[f"{name}_residual"]
    # What the paper's own columns take of a column is theirs: as if they were fitted along.
    joined = np.column_stack([columns, target])
    joined = joined - base @ np.linalg.lstsq(base[train], joined[train], rcond=None)[0]
    columns, target = joined[:, :-1], joined[:, -1]
    size, scale = np.sqrt(np.mean(columns[train] ** 2, axis=0)), np.sqrt(np.mean(target[train] ** 2))
    before = np.sqrt(np.mean(log[f"{name}_columns"][train] ** 2, axis=0))
    kept = size > 1e-3 * before
    columns, families = columns[:, kept] / size[kept], log[f"{name}_families"][kept]
    few, goal = columns[train][::STRIDE], target[train][::STRIDE] / scale
    aside = np.arange(len(goal)) // BLOCK % 5 == 2
    best, threshold = float(np.mean(goal[aside] ** 2)), None
    for one in THRESHOLDS:
        error = goal[aside] - few[aside] @ sparse(few[~aside], goal[~aside], one)
        if np.mean(error**2) < best:
            best, threshold = float(np.mean(error**2)), one
    found = np.zeros(len(families)) if threshold is None else sparse(few, goal, threshold)
    parts: dict[str, float] = {}
    for family in dict.fromkeys(families[found != 0.0]):
        own = families == family
        parts[str(family)] = float(scale * np.sqrt(np.mean((few[:, own] @ found[own]) ** 2)))
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

"""What all tests share: a Hypothesis profile, the longest files first, a diagnosis and a fleet."""

from __future__ import annotations

import gc
import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import Phase, settings

if TYPE_CHECKING:  # What most files do not need takes a second or two to import.
    from eccentric.diagnosis import Diagnosis

# One profile for all: the same examples everywhere, no deadline, few enough to stay quick.
# No shrinking: an example is small as it is, and shrinking at 50 digits takes minutes.
settings.register_profile(
    "eccentric",
    derandomize=True,
    deadline=None,
    max_examples=8,
    database=None,
    phases=(Phase.explicit, Phase.generate),
)
settings.load_profile("eccentric")
# What a command prints is compared: on a slow machine it would tell of its progress in between.
os.environ["ECCENTRIC_PROGRESS"] = "off"
# What SymPy keeps is never garbage, and each collection goes through all of it.
gc.set_threshold(50_000, 20, 50)

BENCH = Path(__file__).resolve().parent.parent / "examples" / "bench"
LONGEST = (
    "test_diagnose", "test_tutorial", "test_flags", "test_misra", "test_real_rigs",
    "test_fleet_run", "test_accuracy_extended", "test_effect_pairs", "test_arm_rest", "test_arm_checks",
    "test_rig_variants", "test_emitted_module", "test_simulate_rig", "test_row_kinds",
    "test_proof", "test_docs", "test_browser", "test_long_logs_used", "test_fleet_ended",
    "test_voltage_alone", "test_linear_fit", "test_encoder", "test_request", "test_empirical",
    "test_closed_forms_numpy", "test_compiled_backend", "test_tilted",
    "test_diagnose_input", "test_api_diagnose", "test_jax", "test_jax_arms", "test_compiled_cache",
    "test_accuracy", "test_target", "test_friction_of_a_voltage", "test_from_python",
    "test_arm_extended", "test_fuzz", "test_selftest", "test_c99", "test_arms_pinocchio",
)  # fmt: skip
"""In the whole suite or among the slow tests: a file is one process's, and begun last it would run alone."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files; the others follow in the order of their names."""
    place = {name: k for k, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path.stem, len(place)))


@pytest.fixture(scope="session")
def bundled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Diagnosis, Path]:
    """The diagnosis of the bundled log, and the folder that `eccentric diagnose` writes; to be read only.

    One for all files that a process runs.
    """
    from eccentric.api import diagnosed
    from eccentric.cli import main

    out, found = tmp_path_factory.mktemp("bundled") / "out", []
    diagnose_logs = diagnosed.diagnose_logs

    def kept(*given: object) -> Diagnosis:
        found.append(diagnose_logs(*given))  # pyright: ignore[reportArgumentType]
        return found[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(diagnosed, "diagnose_logs", kept)
        log, rig = (str(BENCH / name) for name in ("bench.csv.gz", "bench.json"))
        assert 0 == main(["diagnose", log, "--rig", rig, "--out", str(out)])
    return found[0], out


@pytest.fixture(scope="session")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve joints over six months, of which two degrade and one has a bad sensor; to be read only."""
    from eccentric.cli import main

    out = tmp_path_factory.mktemp("fleet") / "fleet"
    assert main(["bench", "--fleet", "--out", str(out)]) == 0
    return out

"""`eccentric emit`: names of one's own, and the folder that is written."""

from pathlib import Path

import pytest

from eccentric.cli import main


@pytest.mark.parametrize(
    "taken", ["math", "stdint", "int", "inline", "class", "numpy", "json", "list", "aux"]
)
def test_a_prefix_that_hides_another_name_is_refused(
    taken: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Headers, modules, keywords of C and Python and devices of Windows: one line, and nothing is written."""
    assert 2 == main(["emit", "c2_parallel", "--prefix", taken, "--out", str(tmp_path / "out")])

    error = capsys.readouterr().err
    required = "required a lower-case C identifier that C and Python leave free"
    start = f"eccentric: error: --prefix: {required}, got '{taken}', a "
    assert (1, True) == (error.count("\n"), error.startswith(start))
    assert [] == list(tmp_path.iterdir())

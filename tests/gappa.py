"""Gappa as the tests ask it."""

import re
import shutil
import subprocess

import pytest


def proved(script: str) -> float:
    """Return the larger end of the one interval that Gappa finds."""
    if shutil.which("gappa") is None:
        pytest.skip("not installed: gappa")
    done = subprocess.run(["gappa"], input=script, capture_output=True, text=True, check=False, timeout=60)
    assert 0 == done.returncode, done.stderr
    ends = re.findall(r"(-?\d+)(?:b(-?\d+))?(?: \{[^}]*\})?[,\]]", done.stderr)
    assert 2 == len(ends), done.stderr
    return max(abs(int(digits)) * 2.0 ** int(power or 0) for digits, power in ends)

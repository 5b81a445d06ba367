"""Runs that are killed or interrupted before a chosen step of their writing: always the same one."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HEAD = """
import os, signal, sys
from pathlib import Path
from eccentric.core import whole_file, whole_files, whole_folder

out, text = Path(sys.argv[1]), sys.argv[2]

def fill(new):
    for name in sys.argv[3:]:
        (new / name).parent.mkdir(parents=True, exist_ok=True)
        (new / name).write_text(text)

def at_step(step, act):
    '''Call `act` before the k-th change of a name on the file system, by whatever function.'''
    left = [step]
    def before(change):
        def changed(*args, **named):
            left[0] -= 1
            act(left[0])
            return change(*args, **named)
        return changed
    for name in ("rename", "replace", "unlink", "mkdir", "rmdir"):
        setattr(os, name, before(getattr(os, name)))

def kill(left):
    if left == 0:
        os.kill(os.getpid(), signal.SIGKILL)

def interrupt(left):
    if left <= 0:
        signal.raise_signal(signal.SIGINT)
"""
# One process that forks: an interpreter for each kill would take minutes.
AT_EACH = """
import shutil
start, k = Path(sys.argv[1] + ".start"), 0
while True:
    k += 1
    into = out.with_name(f"{out.name}{k}")
    shutil.copytree(start, into, symlinks=True)
    child = os.fork()
    if not child:
        at_step(k, ACT)
        try:
            WRITE
        except KeyboardInterrupt:
            os._exit(1)
        os._exit(0)
    if not os.waitpid(child, 0)[1]:
        break
"""


def run(script: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run a script, with the functions above, in an interpreter of its own."""
    return subprocess.run(
        [sys.executable, "-c", HEAD + script, *map(str, arguments)],
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


def at_each_step(act: str, write: str, start: Path, text: str, *names: str, imports: str = "") -> list[Path]:
    """Copies of a folder: in each, `act` befell a run before another step; the last one came to its end.

    `act` is `kill`, or `interrupt`: by Ctrl-C, at that step and at all that follow. `write` is one statement
    that writes files with this text into the folder `into`; `imports` comes before the first copy.
    """
    copy = start.with_name(f"{start.name}.start")
    start.rename(copy)
    done = run(imports + AT_EACH.replace("WRITE", write).replace("ACT", act), start, text, *names)
    assert (done.returncode, done.stderr) == (0, "")
    copies = sorted(start.parent.glob(f"{start.name}[0-9]*"), key=lambda f: int(f.name[len(start.name) :]))
    assert len(copies) > 1
    return copies


def left_by(folder: Path) -> list[str]:
    """Names of what a run has left beside its results: temporary folders and locks."""
    return sorted(path.name for path in folder.rglob(".eccentric-*"))

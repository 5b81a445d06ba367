"""Valid logs of every format, and files damaged at random."""

from __future__ import annotations

import io
import json

import numpy as np
from hypothesis import strategies as st
from scipy.io import savemat

ROWS = 12
NUMBERS = {"time_s": np.arange(ROWS) / 10.0, "current_A": np.linspace(-1.0, 1.0, ROWS)}
TEXT = [f"run {k % 3}" for k in range(ROWS)]
WORDS = (0, 1, 2, 4, 5, 7, 13, 14, 15, 17, 0x7F, 0x80, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
"""Numbers at the borders of types and sizes, and the type codes of MAT elements."""


def csv_bytes() -> bytes:
    """A CSV log."""
    rows = zip(*NUMBERS.values(), TEXT, strict=True)
    lines = [",".join((*NUMBERS, "run")), *(",".join(map(str, row)) for row in rows)]
    return ("# recorded\n" + "\n".join(lines) + "\n").encode()


def json_bytes() -> bytes:
    """A log of BAM's recorder."""
    rows = zip(*NUMBERS.values(), TEXT, strict=True)
    entries = [dict(zip(("t", "i", "run"), row, strict=True)) for row in rows]
    return json.dumps({"mass": 0.5, "motor": "xl330", "homed": True, "entries": entries}).encode()


def mat_bytes(compressed: bool) -> bytes:
    """A MAT file of version 5, or 7 if compressed, with every kind of variable."""
    file = io.BytesIO()
    t = NUMBERS["time_s"]
    signals = np.array([(t, "u"), (t, "i")], dtype=[("v", "O"), ("l", "O")])
    mode = np.array(TEXT, dtype=object)
    variables = {"log": dict(NUMBERS), "mode": mode, "signals": signals, "rate": 250.0}
    savemat(file, variables, do_compression=compressed)
    return file.getvalue()


def mat73_bytes() -> bytes:
    """A MAT file of version 7.3, as far as h5py writes one."""
    import h5py

    file = io.BytesIO()
    with h5py.File(file, "w", userblock_size=512) as h5:
        for name, values in NUMBERS.items():
            item = h5.create_dataset(f"log/{name}", data=values[None, :])
            item.attrs["MATLAB_class"] = np.bytes_(b"double")
        text = h5.create_dataset("#refs#/a", data=np.array([[117, 112]], dtype=np.uint16).T)
        text.attrs["MATLAB_class"] = np.bytes_(b"char")
        h5.create_dataset("mode", data=np.array([text.ref] * ROWS, dtype=h5py.ref_dtype)[None, :])
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    return head.ljust(512, b"\0") + file.getvalue()[512:]


def parquet_bytes() -> bytes:
    """A Parquet log."""
    import pyarrow as pa
    from pyarrow import parquet

    file = io.BytesIO()
    parquet.write_table(pa.table({**NUMBERS, "run": TEXT}), file)
    return file.getvalue()


@st.composite
def damaged(draw: st.DrawFn, valid: bytes) -> bytes:
    """Damage a file in one to four places: bits, numbers at borders, pieces cut or doubled, its end."""
    content = bytearray(valid)
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, max(0, len(content) - 1)))
        span = draw(st.integers(1, 40))
        match draw(st.sampled_from(("bit", "number", "cut", "double", "random", "end"))):
            case "bit" if content:
                content[at] ^= 1 << draw(st.integers(0, 7))
            case "number":
                size = draw(st.sampled_from((1, 2, 4, 8)))
                word = draw(st.sampled_from(WORDS)) % (1 << 8 * size)
                at -= at % draw(st.sampled_from((1, 4, 8)))
                content[at : at + size] = word.to_bytes(size, "little")
            case "cut":
                del content[at : at + span]
            case "double":
                content[at:at] = content[at : at + span]
            case "random":
                content[at : at + span] = draw(st.binary(max_size=40))
            case "end":
                del content[at:]
    return bytes(content)


def files(*valid: bytes) -> st.SearchStrategy[bytes]:
    """Damaged files, and now and then bytes that never were one."""
    return st.one_of(*map(damaged, valid), *map(damaged, valid), st.binary(max_size=300))


def texts(*valid: bytes) -> st.SearchStrategy[str]:
    """Damaged texts."""
    return st.one_of(*map(damaged, valid)).map(lambda content: content.decode(errors="replace"))

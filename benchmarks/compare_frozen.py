"""Compares two folders of frozen results, written by benchmarks/freeze.py, and names each difference.

    python benchmarks/compare_frozen.py BEFORE AFTER [--renamed NAMES.json] [--tolerance 1e-9] [--lines 3]

Files are paired by their path.  How they are compared follows from it:

numbers     documents/ except printed lines.  Keys, texts, lists and truth values of JSON have to be equal, verdicts
            among them; a number may differ by the tolerance times its magnitude or, where an object has a
            `std_error`, times that one for every number of the object, whichever is larger; a list of them counts
            entry by entry.  In HTML this applies
            to JSON in scripts, whose arrays in base64 are decoded: of 32 bits, they may differ by a unit in the last
            place.  The rest of a page, emitted code, CSV and TOML are compared line by line; lines that differ in
            decimal numbers alone agree if the numbers do (coordinates of SVG: to 1e-5).  The digest of a program
            is left out, since it follows from the fitted numbers.
signatures  api/, after the names of the first folder are replaced by those of the map, old name to new name.
text        everything else, by bytes: the first lines that differ, and how many.

Prints `file: place: before, then after` for each difference, and exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
import base64
import gzip
import itertools
import json
import math
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

TOLERANCE = 1e-9
NUMBER = re.compile(r"((?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.]))")
"""A decimal number that is a word of its own, and no part of a name."""
DIGEST = re.compile(r"(program |_PROGRAM (?:==|!=)? ?0x)[0-9a-f]{8}")
SCRIPT = re.compile(r'(<script[^>]*type="application/json"[^>]*>)(.*?)(?=</script>)', re.DOTALL)
SINGLE = 2.0**-23
ABSENT = object()


def compare_values(
    before: Any, after: Any, tolerance: float, at: str = "", scale: float | list[float] = 0.0
) -> Iterator[str]:
    """Yield a line for each place where two JSON documents differ; `scale` is a standard error, if there is one."""
    if isinstance(before, dict) and isinstance(after, dict):
        before, after = _decoded(before), _decoded(after)
        if isinstance(before, list) or isinstance(after, list):
            yield from compare_values(before, after, max(tolerance, SINGLE), at)
            return
        error = before.get("std_error")
        own = [_size(x) for x in error] if isinstance(error, list) else _size(error)
        for key in sorted({*before, *after}):
            one, two = before.get(key, ABSENT), after.get(key, ABSENT)
            if one is ABSENT or two is ABSENT:
                yield f"{at}/{key}: only {'after' if one is ABSENT else 'before'}"
            else:
                yield from compare_values(one, two, tolerance, f"{at}/{key}", own)
    elif isinstance(before, list) and isinstance(after, list):
        if len(before) != len(after):
            yield f"{at}: {len(before)} entries, then {len(after)}"
            return
        scales = scale if isinstance(scale, list) and len(scale) == len(before) else [scale] * len(before)
        for number, (one, two) in enumerate(zip(before, after, strict=True)):
            yield from compare_values(one, two, tolerance, f"{at}/{number}", scales[number])
    elif not _agree(before, after, tolerance, 0.0 if isinstance(scale, list) else scale):
        one, two = (value if isinstance(value, str) else repr(value) for value in (before, after))
        yield f"{at}: {_around(one, one, two)}, then {_around(two, one, two)}"


def _size(error: Any) -> float:
    """The size of a standard error; 0 for none."""
    return abs(error) if _is_number(error) and math.isfinite(error) else 0.0


def _decoded(value: dict[str, Any]) -> Any:
    """The numbers of an array that Bokeh has packed; anything else as it is."""
    packed = value.get("array")
    if (
        value.get("type") != "ndarray"
        or not isinstance(packed, dict)
        or not isinstance(packed.get("data"), str)
    ):
        return value
    content = base64.b64decode(packed["data"])
    content = gzip.decompress(content) if content[:2] == b"\x1f\x8b" else content
    return np.frombuffer(content, value["dtype"]).tolist()


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _agree(before: Any, after: Any, tolerance: float, scale: float) -> bool:
    """Whether two numbers agree, or two other values are equal; true is not 1."""
    if not (_is_number(before) and _is_number(after)):
        return type(before) is type(after) and before == after
    if math.isnan(before) or math.isnan(after):
        return math.isnan(before) and math.isnan(after)
    return math.isclose(before, after, rel_tol=tolerance, abs_tol=tolerance * scale)


def compare_lines(before: str, after: str, most: int, close: Any = None) -> Iterator[str]:
    """Yield the first lines that differ and how many more there are; `close(number, number)` accepts numbers."""
    pairs = itertools.zip_longest(before.splitlines(), after.splitlines())
    found = 0
    for number, (one, two) in enumerate(pairs, 1):
        if one == two or (
            close and one is not None and two is not None and _same_but_numbers(one, two, close)
        ):
            continue
        found += 1
        if found <= most:
            sides = (
                "no such line" if line is None else repr(_around(line, one or "", two or ""))
                for line in (one, two)
            )
            yield f"line {number}: {', then '.join(sides)}"
    if found > most:
        yield f"{found - most} further lines differ"
    if not found and before != after and not close:
        yield "ends of lines differ"


def _around(text: str, one: str, two: str) -> str:
    """A text as it is or, of a long one, the part where two of them begin to differ."""
    if len(text) <= 160:
        return text
    start = next(
        (k for k, (a, b) in enumerate(zip(one, two, strict=False)) if a != b), min(len(one), len(two))
    )
    return f"... {text[max(0, start - 40) : start + 80]} ... (column {start + 1})"


def _same_but_numbers(before: str, after: str, close: Any) -> bool:
    """Whether two lines differ in numbers alone, and these agree."""
    parts = [NUMBER.split(DIGEST.sub(r"\1", line)) for line in (before, after)]
    if len(parts[0]) != len(parts[1]):
        return False
    rows = list(zip(*parts, strict=True))
    return all(one == two for one, two in rows[::2]) and all(
        one == two or close(float(one), float(two)) for one, two in rows[1::2]
    )


def compare_pages(before: str, after: str, tolerance: float, most: int) -> Iterator[str]:
    """Compare HTML: JSON in scripts as numbers, the rest line by line."""
    scripts = [SCRIPT.findall(text) for text in (before, after)]
    if len(scripts[0]) == len(scripts[1]):
        for number, ((_, one), (_, two)) in enumerate(zip(*scripts, strict=True), 1):
            found = list(compare_values(json.loads(one), json.loads(two), tolerance, f"script {number} "))
            yield from found[:most]
            if len(found) > most:
                yield f"script {number}: {len(found) - most} further places differ"
    yield from compare_lines(SCRIPT.sub(r"\1", before), SCRIPT.sub(r"\1", after), most)


def renamed(signatures: Any, names: Mapping[str, str]) -> Any:
    """Signatures with names replaced, as whole words, in keys and texts; a name may have dots."""
    if not names:
        return signatures
    words = re.compile(
        r"(?<![\w.])(" + "|".join(map(re.escape, sorted(names, key=len, reverse=True))) + r")(?!\w)"
    )

    def new(text: str) -> str:
        return words.sub(lambda found: names[found[1]], text)

    return {new(name): new(text) for name, text in signatures.items()}


def compare_files(
    name: str, before: Path, after: Path, tolerance: float, names: Mapping[str, str], most: int
) -> Iterator[str]:
    """Yield the differences of two files by the mode of their path within the folder."""
    contents = before.read_bytes(), after.read_bytes()
    if contents[0] == contents[1] and not (names and name.startswith("api/")):
        return
    one, two = (content.decode("utf-8", "replace") for content in contents)
    part, suffix = name.partition("/")[0], Path(name).suffix
    if part == "api" and suffix == ".json":
        yield from compare_values(renamed(json.loads(one), names), json.loads(two), 0.0)
    elif part != "documents" or suffix == ".txt":
        yield from compare_lines(one, two, most)
    elif suffix == ".json":
        yield from compare_values(json.loads(one), json.loads(two), tolerance)
    elif suffix == ".html":
        yield from compare_pages(one, two, tolerance, most)
    else:
        absolute = 1e-5 if suffix == ".svg" else 0.0
        yield from compare_lines(
            one, two, most, lambda a, b: math.isclose(a, b, rel_tol=tolerance, abs_tol=absolute)
        )


def compare(
    before: Path,
    after: Path,
    tolerance: float = TOLERANCE,
    names: Mapping[str, str] | None = None,
    most: int = 3,
) -> Iterator[str]:
    """Yield a line for each difference of two frozen folders."""
    sides = [
        {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()} for folder in (before, after)
    ]
    for name in sorted(sides[0] | sides[1]):
        if name not in sides[0] or name not in sides[1]:
            yield f"{name}: only {'before' if name in sides[0] else 'after'}"
            continue
        for line in compare_files(name, before / name, after / name, tolerance, names or {}, most):
            yield f"{name}: {line}"


def main() -> int:
    """Compare, print, and return 1 if anything differs."""
    layout = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=layout)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--renamed", type=Path, help="JSON object: old name -> new name, of the public API")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="relative (1e-9)")
    parser.add_argument("--lines", type=int, default=3, help="lines of a text that are shown (3)")
    arguments = parser.parse_args()
    for folder in (arguments.before, arguments.after):
        if not folder.is_dir():
            parser.error(f"{folder}: no such folder")
    names = json.loads(arguments.renamed.read_text(encoding="utf-8")) if arguments.renamed else {}
    count, files = 0, set[str]()
    for line in compare(arguments.before, arguments.after, arguments.tolerance, names, arguments.lines):
        print(line)
        count += 1
        files.add(line.partition(":")[0])
    compared = sum(path.is_file() for path in arguments.before.rglob("*"))
    print(f"{compared} files compared, {count} differences in {len(files)} files")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())

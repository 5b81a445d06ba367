"""`eccentric diagnose`: what does the model lack on this log?"""

import argparse
import json
import shutil
import sys
import webbrowser
from pathlib import Path

from eccentric.cli.arguments import add_folder, add_logs, distinct
from eccentric.diagnosis import Diagnosis, diagnose, diagnosis_document, diagnosis_lines, script
from eccentric.emission import complete, write
from eccentric.errors import InputError
from eccentric.model import load_model
from eccentric.output import own_folder, whole_folder
from eccentric.report import report

NAME = "diagnose"
HELP = "find what the model lacks on a log, add it, emit it, report the error before and after"
EXAMPLE = """eccentric diagnose examples/bench/bench.csv.gz --rig examples/bench/bench.json --out build/bench
eccentric diagnose my.csv --rig my.toml --effects my_effects.py --out build/mine"""

# What is written, as the report explains it.
_FILES = (
    ("diagnosis.json", "the figures of this page, for programs"),
    (
        "model.py",
        "the extended model as a derivation: python model.py prints it, eccentric emit model.py emits it",
    ),
)
_EMITTED = {
    ".py": "the extended model in NumPy",
    ".h": "its C99 header",
    ".c": "its C99 source",
    "_selftest.c": "a self-test of the source, for your board",
    "_vectors.h": "what the self-test compares with",
    "_proof.c": "the driver of a proof that the source is free of undefined behaviour",
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add_logs(parser)
    parser.add_argument("--effects", metavar="FILE", type=Path, help="a Python file with effects of your own")
    add_folder(parser, "the report and the extended model")
    parser.add_argument("--open", action="store_true", help="open the report in the browser")


def run(args: argparse.Namespace) -> int:
    """Diagnose, write the folder, print the result; return 0."""
    distinct(args.logs)
    own_folder(args.out)
    scripts = _own(args.effects, args.model)
    for own in scripts:
        if own.name == "model.py" or own.stem.endswith("_extended"):
            raise InputError(f"{own}: required another name: the result has a file of this one")
    if len({own.resolve() for own in scripts}) > len(called := {own.name for own in scripts}):
        raise InputError(
            f"--effects and --model: required files of different names, received {called.pop()} twice"
        )
    found = diagnose(args.logs, args.rig, args.model, args.effects, _progress())
    with whole_folder(args.out, NAME) as folder:
        names = _write(found, folder)
    for warning in found.warnings:
        print(f"eccentric: warning: {warning}", file=sys.stderr)
    print("\n".join(diagnosis_lines(found)))
    print(f"{args.out}: {', '.join(names)}")
    if args.open and not webbrowser.open((Path(args.out).resolve() / "report.html").as_uri()):
        print("eccentric: warning: no browser was found to open the report", file=sys.stderr)
    return 0


def _own(effects: Path | None, model: str | None) -> list[Path]:
    """Scripts of the user's own, which travel with the result."""
    return [Path(one) for one in (effects, model) if one is not None and Path(one).suffix == ".py"]


def _write(found: Diagnosis, folder: Path) -> list[str]:
    text = json.dumps(diagnosis_document(found), indent=1, ensure_ascii=False, allow_nan=False)
    (folder / "diagnosis.json").write_text(text + "\n", encoding="utf-8")
    (folder / "model.py").write_text(script(found), encoding="utf-8")
    own = _own(found.asked.effects, found.asked.model)
    for path in own:
        shutil.copyfile(path, folder / path.name)
    model = load_model(folder / "model.py")
    emitted = complete(model, "eccentric diagnose", "model.py")
    write(emitted, folder)
    files = [*_FILES, *((path.name, "a script of your own") for path in own)]
    files += [(name, _EMITTED[name.rpartition(model.name)[2]]) for name in emitted]
    (folder / "report.html").write_text(report(found, files), encoding="utf-8")
    top = [name for name in emitted if "/" not in name]
    return ["report.html", "diagnosis.json", "model.py", *top, "check/"]


def _progress():  # noqa: ANN202 - a function or None
    """Stage by stage on a terminal, silent elsewhere."""
    if not sys.stderr.isatty():
        return None
    return lambda line: print(f"  {line}", file=sys.stderr)

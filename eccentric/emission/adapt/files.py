"""A model, its prior and what is asked -> the files of its estimator."""

from __future__ import annotations

import re
from collections.abc import Mapping

from eccentric.emission.adapt.prior import Prior
from eccentric.emission.adapt.settings import Adaptation
from eccentric.emission.adapt.view import view
from eccentric.emission.backends import BACKENDS
from eccentric.emission.free_text import plain
from eccentric.emission.templates import template
from eccentric.model import Model
from eccentric.version import __version__


def render_adapt(
    model: Model,
    files: Mapping[str, str],
    prior: Prior,
    asked: Adaptation | None = None,
    command: str = "eccentric emit --adapt",
) -> dict[str, str]:
    """The files of the estimator, file name -> text.

    Args:
        model: what was emitted, with the defaults that the estimator starts from.
        files: the output of `render`, with the C.
        prior: of its coefficients.
        asked: forgetting and false alarms.
        command: that writes the files, for their banner.

    Raises:
        InputError: the model lacks a function that the estimator calls, or does not depend on friction in a
            way that it can follow.
    """
    asked = asked or Adaptation()
    digest = re.findall(r"_PROGRAM (0x\w+)", files[f"{model.name}.h"])[0]
    seen = view(model, prior, asked, digest, files[f"{model.name}.c"])
    banner = (
        f"Generated: do not edit. Written by `{plain(command)}`, beside {model.name}.c",
        f"(eccentric {__version__}, program {digest[2:].removesuffix('UL')}).",
        "Estimator of the friction coefficients.",
    )
    return {
        file: (BACKENDS[backend].banner(banner) if backend else "") + template(f"adapt/{kind}").render(seen)
        for kind, file, backend in (
            ("header.h", f"{model.name}_adapt.h", "c99"),
            ("source.c", f"{model.name}_adapt.c", "c99"),
            ("module.py", f"{model.name}_adapt.py", "numpy"),
            ("proof.c", f"check/{model.name}_adapt_proof.c", ""),
        )
    }

"""Load a user's own effects from a file, given by path."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from eccentric.effects.effect import Effect
from eccentric.effects.setting import Setting
from eccentric.errors import InputError
from eccentric.scripts import asks, run_script


def load_effects(path: str | Path, setting: Setting) -> tuple[Effect, ...]:
    """The effects of a script: what its `effects(setting)` returns, or its module-level `effect`.

    Raises:
        InputError: there is no such script, it raises an error, or it has neither name with the right type.
    """
    path = Path(path)
    if path.suffix != ".py" or not path.is_file():
        raise InputError(f"{path}: no such script of effects (.py)")
    name = f"eccentric_effects_{path.stem}"
    asks(str(path), path.resolve())
    try:
        module = run_script(path.resolve(), name)
        made = getattr(module, "effects", None)
        found = made(setting) if callable(made) else getattr(module, "effect", None)
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path}: the effects stopped with {type(error).__name__}: {error}") from error
    finally:
        sys.modules.pop(name, None)
    found = (found,) if isinstance(found, Effect) else found
    if not isinstance(found, Iterable):
        raise InputError(
            f"{path}: a function `effects(setting)` or an `effect` of type Effect is required,"
            f" received {type(found).__name__}"
        )
    found = tuple(found)
    if wrong := [type(one).__name__ for one in found if not isinstance(one, Effect)]:
        raise InputError(f"{path}: effects of type Effect are required, received {wrong[0]}")
    return found

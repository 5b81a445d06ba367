"""What a person asked of the search: effects that the model has from the start, and what it may offer."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from eccentric.effects import FAMILIES, Effect
from eccentric.errors import InputError

__all__ = ["SearchRequest", "members"]


@dataclass(frozen=True)
class SearchRequest:
    """Restrictions of the search, each a list of families or ids of effects.

    including: part of the model from the start; without: not offered; only: nothing else is offered (all if
    empty).
    """

    including: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    only: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """What was asked, in words; "" for nothing."""
        parts = (("with", self.including), ("without", self.without), ("only", self.only))
        return "; ".join(f"{word} {', '.join(names)}" for word, names in parts if names)

    def restricted(self, offered: Sequence[Effect]) -> tuple[Effect, ...]:
        """The effects that the search may choose from.

        Raises:
            InputError: a name is neither a family nor the id of an effect; or nothing remains of `only`.
        """
        for word, names in (("without", self.without), ("only", self.only)):
            for name in names:
                _require_known(word, name, offered)
        left = tuple(
            effect
            for effect in offered
            if not _named(effect, self.without) and (not self.only or _named(effect, self.only))
        )
        if self.only and not left:
            raise InputError(
                f"only: a family that this log can show is required, received {', '.join(self.only)};"
                f" it can show {', '.join(_families(offered))}"
            )
        return left


def members(word: str, name: str, offered: Sequence[Effect]) -> list[Effect]:
    """The effects that a name stands for: a family, or one id.

    Raises:
        InputError: there is no such effect, or this log cannot show it; `word` begins the message.
    """
    _require_known(word, name, offered)
    found = [effect for effect in offered if _named(effect, (name,))]
    if not found:
        raise InputError(
            f"{word}: an effect that this log can show is required, received {name}; it can show"
            f" {', '.join(_families(offered))}"
        )
    return found


def _named(effect: Effect, names: Iterable[str]) -> bool:
    return any(name in (effect.id, effect.family) for name in names)


def _families(offered: Iterable[Effect]) -> list[str]:
    return list(dict.fromkeys(effect.family for effect in offered))


def _require_known(word: str, name: str, offered: Sequence[Effect]) -> None:
    families = dict.fromkeys([*FAMILIES, *_families(offered)])
    ids = [effect.id for effect in offered]
    if name in families or name in ids:
        return
    family = name.partition("[")[0]
    own = [effect_id for effect_id in ids if effect_id.partition("[")[0] == family]
    if own:
        raise InputError(
            f"{word}: an effect is required, received {name}; of {family} there are {', '.join(own)}"
        )
    if family in families:
        return
    near = difflib.get_close_matches(family, families, 1)
    hint = f" (did you mean {near[0]}?)" if near else ""
    raise InputError(f"{word}: an effect is required, received {name}{hint}; there are {', '.join(families)}")

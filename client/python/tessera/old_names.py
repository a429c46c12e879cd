"""Names of version 0.1 that still work in 0.2, with a DeprecationWarning. Version 0.3 will not have them."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from .errors import InvalidInput

if TYPE_CHECKING:
    from .records import Members

MODULE_NAMES = {"People": "Members", "Person": "Member"}


def warn(old: str, present: str) -> None:
    warnings.warn(f"tessera: '{old}' is now '{present}'", DeprecationWarning, stacklevel=3)


class SessionNames:
    """Of Session."""

    def people(self) -> Members:
        warn("people", "members")
        return self.members()  # type: ignore[attr-defined, no-any-return]

    def gesture(self) -> int:
        warn("gesture", "new_edit_group")
        return self.new_edit_group()  # type: ignore[attr-defined, no-any-return]


class MembersNames:
    """Of Members."""

    @property
    def people(self) -> Any:
        warn("people", "members")
        return self.members  # type: ignore[attr-defined]


class NodeStateNames:
    """Of NodeState."""

    @property
    def units_in_hand(self) -> int:
        warn("units_in_hand", "units_in_flight")
        return self.units_in_flight  # type: ignore[attr-defined, no-any-return]


class SampleCountNames:
    """Of Frame and Summary."""

    @property
    def samples_least(self) -> int:
        warn("samples_least", "min_samples")
        return self.min_samples  # type: ignore[attr-defined, no-any-return]

    @property
    def samples_most(self) -> int:
        warn("samples_most", "max_samples")
        return self.max_samples  # type: ignore[attr-defined, no-any-return]


def edit_group_of(edit_group: int, old: dict[str, int]) -> int:
    """The edit group of a transaction, also as the argument `gesture`."""
    unknown = sorted(set(old) - {"gesture"})
    if unknown:
        raise InvalidInput(f"transaction() has no argument '{unknown[0]}'")
    if "gesture" in old:
        warn("gesture", "edit_group")
    return old.get("gesture", edit_group)

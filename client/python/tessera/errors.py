"""What can go wrong, as exceptions. Every text names what, why and what helps."""

from __future__ import annotations

from typing import Sequence


class Error(Exception):
    """Whatever this package raises on purpose."""


class InvalidInput(Error, ValueError):
    """The call itself is wrong: an unknown name, a value of the wrong shape."""


class Unavailable(Error):
    """The master does not answer, or is gone."""


class Refused(Error):
    """The master says no; nothing has changed. `problems` has one text for each reason."""

    def __init__(self, problems: str | Sequence[str]) -> None:
        self.problems: tuple[str, ...] = (problems,) if isinstance(problems, str) else tuple(problems)
        super().__init__("; ".join(self.problems) or "the master refuses and does not say why")


class Malformed(Error):
    """Bytes or values of a peer that break the protocol."""

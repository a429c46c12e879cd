"""Exceptions. Every text names the object, the cause and a remedy."""

from __future__ import annotations

from typing import Sequence


class Error(Exception):
    """Base class of all errors of this package."""


class InvalidInput(Error, ValueError):
    """The call itself is wrong: an unknown name, a value of the wrong shape."""


class Unavailable(Error):
    """The master does not answer."""


class Refused(Error):
    """The master rejected the request; nothing has changed. `problems` has one text for each reason."""

    def __init__(self, problems: str | Sequence[str]) -> None:
        self.problems: tuple[str, ...] = (problems,) if isinstance(problems, str) else tuple(problems)
        super().__init__("; ".join(self.problems) or "the master refuses and does not say why")


class Malformed(Error):
    """Bytes or values of a peer that break the protocol."""

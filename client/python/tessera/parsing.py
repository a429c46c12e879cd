"""Parses messages from untrusted bytes."""

from __future__ import annotations

import warnings
from typing import Any

from .errors import Malformed

# The parser stops there and warns instead of failing; the length reveals it.
warnings.filterwarnings("ignore", "Unexpected end-group tag", RuntimeWarning)


def parsed(message_type: Any, data: bytes) -> Any:
    """A message of this type. Raises Malformed."""
    message = message_type()
    try:
        length = message.MergeFromString(data)
    except Exception as error:  # the parser's own, which differs between its implementations
        raise Malformed("not this protocol") from error
    if length != len(data):
        raise Malformed("not this protocol")
    return message

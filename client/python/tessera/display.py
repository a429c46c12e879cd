"""Messages about the display of a scene."""

from __future__ import annotations

import math
from typing import Any, Iterable, Sequence

from .errors import InvalidInput
from .proto import control_pb2

Message = Any
_MAX_LAYERS = 4


def move_head(position: Sequence[float], orientation: Sequence[float]) -> Message:
    """Raises InvalidInput for an invalid position or orientation."""
    message = control_pb2.Control()
    head = message.move_head.head
    head.position.extend(_numbers(position, 3, "position"))
    turn = _numbers(orientation, 4, "orientation")
    largest = max(abs(value) for value in turn)
    if largest == 0.0:
        raise InvalidInput("orientation: the quaternion must not be zero")
    turn = [value / largest for value in turn]  # so that no square over- or underflows
    length = math.hypot(*turn)
    head.orientation.extend(value / length for value in turn)
    return message


def adjustment(eye_separation: float | None, zero_parallax: float | None, exposure: float | None, pattern: bool | None,
               shown_layers: Iterable[int] | None) -> Message:
    """Raises InvalidInput for impossible layers and invalid numbers."""
    message = control_pb2.Control()
    change = message.adjust_display.adjustment
    change.SetInParent()
    for name, value in (("eye_separation", eye_separation), ("zero_parallax", zero_parallax), ("exposure", exposure)):
        if value is not None:
            setattr(change, name, _numbers([value], 1, name)[0])
    if pattern is not None:
        change.pattern = pattern
    if shown_layers is not None:
        change.shown_layers = 0
        for layer in shown_layers:
            if not 0 <= layer < _MAX_LAYERS:
                raise InvalidInput(f"shown_layers: there is no layer {layer}: they are counted from 0 to {_MAX_LAYERS - 1}")
            change.shown_layers |= 1 << layer
    return message


def _numbers(values: Sequence[float], count: int, what: str) -> list[float]:
    numbers = [float(value) for value in values]
    if len(numbers) != count or not all(math.isfinite(number) for number in numbers):
        raise InvalidInput(f"{what}: expected {count} finite number{'s' if count > 1 else ''}")
    return numbers

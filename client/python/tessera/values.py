"""What the values of scene objects are made of, and how `objects.py` lists fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Vec4 = tuple[float, float, float, float]
Matrix = tuple[float, ...]  # 16 numbers, column by column

IDENTITY: Matrix = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
ROOT_ID = 1


@dataclass(frozen=True)
class Blob:
    """Immutable bytes by name; what they are is told by `Scene.bytes_of`."""

    hash: bytes = b""  # BLAKE2b-256
    byte_size: int = 0  # 0 = nothing there


@dataclass(frozen=True)
class Object:
    """What all kinds have. A value: it stays as it was read; ask the scene again for newer ones."""

    id: int
    name: str = ""


class FieldRow(NamedTuple):
    """A field in the order of its message. Bit number - 1 of a mask stands for it."""

    name: str
    number: int
    codec: str  # a word of `fields.py`
    choices: tuple[str, ...] = ()


class KindRow(NamedTuple):
    """A kind of objects: `name` as in messages, `plural` as in paths."""

    name: str
    plural: str
    type: type[Object]
    is_placed: bool  # may be a child of the root or of a transform
    fields: tuple[FieldRow, ...]

"""The base types of scene objects, and of the field tables in `objects.py`."""

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
    """A reference to immutable bytes; `Scene.bytes_of` returns them."""

    hash: bytes = b""  # BLAKE2b-256
    byte_size: int = 0  # 0 = empty


@dataclass(frozen=True)
class Object:
    """The common base of all kinds. An immutable value: read the scene again for a newer one."""

    id: int
    name: str = ""


class FieldRow(NamedTuple):
    """A field, in the order of its message; bit (number - 1) of a field mask."""

    name: str
    number: int
    codec: str  # a name in `fields.py`
    choices: tuple[str, ...] = ()


class KindRow(NamedTuple):
    """A kind of objects: `name` as in messages, `plural` as in paths."""

    name: str
    plural: str
    type: type[Object]
    is_placed: bool  # may be a child of the root or of a transform
    fields: tuple[FieldRow, ...]

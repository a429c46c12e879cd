"""A copy of the master's scene, updated by change lists. No I/O."""

from __future__ import annotations

import difflib
import math
from typing import Any, Iterator, Sequence

from .camera import MAX_MOTION, multiply
from .errors import InvalidInput, Malformed
from .fields import KINDS, Kind, kind_in, kind_named
from .objects import Root, Transform
from .proto import scene_pb2
from .values import IDENTITY, Matrix, Object, ROOT_ID

Message = Any
Version = tuple[int, int]  # epoch, number

_PLACES = {kind.name: i for i, kind in enumerate(KINDS)}


class Mirror:
    """Objects by id, by path, and as values."""

    def __init__(self) -> None:
        self.version: Version = (0, 0)
        self._objects: dict[int, tuple[Kind, Message]] = {}
        self._values: dict[int, Object] = {}  # created on demand
        self._ids: dict[tuple[str, bytes], set[int]] = {}  # by kind and name

    def apply(self, changes: Message) -> None:
        """Applies a snapshot, or changes based on `version`. On Malformed the mirror is empty: request a snapshot."""
        try:
            known = getattr(changes, "from")  # a Python keyword
            if known.number == 0:
                self._clear()
            elif (known.epoch, known.number) != self.version:
                raise Malformed("changes based on another version than this one")
            for entry in changes.entries:
                self._apply(entry)
            self.version = (changes.to.epoch, changes.to.number)
        except Malformed:
            self._clear()
            self.version = (0, 0)
            raise

    def _clear(self) -> None:
        self._objects, self._values, self._ids = {}, {}, {}

    def _apply(self, entry: Message) -> None:
        self._values.pop(entry.id, None)
        known = self._objects.get(entry.id)
        if entry.action == scene_pb2.Entry.REMOVE:
            if known is None:
                raise Malformed("an unknown object is removed")
            self._forget(entry.id, *known)
            return
        kind, message = kind_in(entry.object)
        if entry.action == scene_pb2.Entry.CREATE:
            if known is not None:
                raise Malformed("an object is created twice")
            self._remember(entry.id, kind, message)
            return
        if entry.action != scene_pb2.Entry.UPDATE or known is None or known[0] is not kind:
            raise Malformed("an update of an unknown object, or of another kind")
        if entry.mask & ~sum(kind.bits.values()):
            raise Malformed("an update has unknown fields")
        self._forget(entry.id, *known)
        target = known[1]
        for field, bit in kind.bits.items():
            if entry.mask & bit:
                copy_field(message, target, field)
        self._remember(entry.id, kind, target)

    def _remember(self, object_id: int, kind: Kind, message: Message) -> None:
        self._objects[object_id] = (kind, message)
        self._ids.setdefault((kind.name, message.name), set()).add(object_id)

    def _forget(self, object_id: int, kind: Kind, message: Message) -> None:
        del self._objects[object_id]
        same = self._ids[kind.name, message.name]
        same.discard(object_id)
        if not same:
            del self._ids[kind.name, message.name]

    def __len__(self) -> int:
        return len(self._objects)

    def __contains__(self, object_id: int) -> bool:
        return object_id in self._objects

    def ids(self) -> list[int]:
        return sorted(self._objects)

    def entry(self, object_id: int) -> tuple[Kind, Message]:
        """Raises InvalidInput."""
        try:
            return self._objects[object_id]
        except KeyError:
            raise InvalidInput(f"the scene has no object {object_id}") from None

    def value(self, object_id: int) -> Object:
        """Raises InvalidInput for an unknown id, Malformed for values that the master should have rejected."""
        known = self._values.get(object_id)
        if known is None:
            kind, message = self.entry(object_id)
            known = self._values[object_id] = kind.read(object_id, message)
        return known

    def find(self, path: str) -> int:
        """The id of "root", "kind/name", "kind/name@id" or "kind/@id". Raises InvalidInput: unknown with the nearest
        path, ambiguous with all candidates."""
        if path == "root":
            return ROOT_ID
        word, slash, name = path.partition("/")
        if not slash:
            raise InvalidInput(f"'{path}' is not a path: expected kind/name, as in materials/red, or 'root'")
        kind = kind_named(word)
        same = self._ids.get((kind.name, name.encode("utf-8", "surrogateescape")), set())
        if len(same) == 1:
            return next(iter(same))
        if len(same) > 1:
            raise InvalidInput(f"'{path}' means several objects: " +
                               ", ".join(self.path(object_id) for object_id in sorted(same)[:10]))
        front, at, number = name.rpartition("@")
        if at and number.isdecimal():
            found = self._objects.get(int(number))
            if found and found[0] is kind and front in ("", self.name(int(number))):
                return int(number)
        names = [known.decode("utf-8", "surrogateescape") for of, known in self._ids if of == kind.name]
        near = difflib.get_close_matches(name, names, 1)
        raise InvalidInput(f"the scene has no {path}" + (f": did you mean {kind.plural}/{near[0]}?" if near else ""))

    def name(self, object_id: int) -> str:
        return bytes(self.entry(object_id)[1].name).decode("utf-8", "surrogateescape")

    def path(self, object_id: int) -> str:
        """The shortest unambiguous path of the object."""
        if object_id == ROOT_ID:
            return "root"
        kind, message = self.entry(object_id)
        name = self.name(object_id)
        alone = name != "" and len(self._ids[kind.name, message.name]) == 1
        return f"{kind.plural}/{name}" if alone else f"{kind.plural}/{name}@{object_id}"

    def of_kind(self, kind: Kind) -> Iterator[int]:
        return (object_id for object_id in self.ids() if self._objects[object_id][0] is kind)

    def world_matrix(self, object_id: int) -> Matrix:
        """World from parent, for the first occurrence of an object in the graph. Raises InvalidInput."""
        return world_at(self._transforms_above(object_id), 0.0)

    def world_motion(self, object_id: int) -> list[Matrix]:
        """world_matrix at uniform motion keys after the first, the last when the shutter closes; empty: no motion. If
        several transforms above move, the maximum number of keys. Raises InvalidInput."""
        above = self._transforms_above(object_id)
        steps = _steps_of([t for t in above if any(step != t.matrix for step in t.motion)])
        return [world_at(above, i / steps) for i in range(1, steps + 1)]

    def _transforms_above(self, object_id: int) -> list[Transform]:
        """The transforms of its first occurrence in the graph, itself included, from the root down. Raises InvalidInput."""
        parents: dict[int, int] = {}
        for parent in self.ids():
            if self._objects[parent][0].type in (Root, Transform):
                for child in self._objects[parent][1].children:
                    parents.setdefault(child, parent)
        path: list[Transform] = []
        at = object_id
        for _ in range(len(self._objects) + 1):
            if at == ROOT_ID:
                return path[::-1]
            value = self.value(at)
            if isinstance(value, Transform):
                path.append(value)
            if at not in parents:
                break
            at = parents[at]
        raise InvalidInput(f"{self.path(object_id)} has no place in the graph: attach it to the root or a transform")


def world_at(transforms: Sequence[Transform], time: float) -> Matrix:
    """The product of transforms from the root down, at `time`, a fraction of the shutter time."""
    matrix = IDENTITY
    for transform in transforms:
        matrix = multiply(matrix, _matrix_at(transform, time))
    return matrix


def _matrix_at(transform: Transform, time: float) -> Matrix:
    """Linear interpolation between motion keys, exact at both ends."""
    keys = (transform.matrix, *transform.motion)
    step = min(int(time * len(transform.motion)), max(len(transform.motion) - 1, 0))
    fraction = time * len(transform.motion) - step
    if fraction == 0.0:
        return keys[step]
    if fraction == 1.0:
        return keys[step + 1]
    return tuple(a + (b - a) * fraction for a, b in zip(keys[step], keys[step + 1]))


def _steps_of(moving: Sequence[Transform]) -> int:
    """As in the importer and the nodes (mediator/scene/motion.h)."""
    counts = [len(transform.motion) for transform in moving]
    if len(counts) < 2:
        return sum(counts)
    together = math.lcm(*counts)
    unit = together if together <= MAX_MOTION else max(counts)
    return MAX_MOTION // unit * unit


def copy_field(source: Message, target: Message, field: str) -> None:
    """Of two messages of one kind."""
    target.ClearField(field)
    value = getattr(source, field)
    if hasattr(value, "CopyFrom"):
        getattr(target, field).CopyFrom(value)
        getattr(target, field).SetInParent()
    elif hasattr(value, "extend"):
        getattr(target, field).extend(value)
    else:
        setattr(target, field, value)

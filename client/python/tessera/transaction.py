"""Edits that are committed as one atomic transaction."""

from __future__ import annotations

from typing import Any, Protocol

from .blobs import BlobHeap
from .errors import InvalidInput
from .fields import KIND_OF_TYPE, KINDS, Kind, kind_named, object_id
from .mirror import Mirror
from .proto import scene_pb2
from .records import Committed
from .values import Object, ROOT_ID

Message = Any
_CREATE, _UPDATE, _REMOVE = scene_pb2.Entry.CREATE, scene_pb2.Entry.UPDATE, scene_pb2.Entry.REMOVE


class Editor(Protocol):
    """The interface that a transaction needs from its session."""

    def mirror(self) -> Mirror:
        """The current scene."""
        ...

    def new_id(self) -> int: ...


class Transaction:
    """Collects changes and sends them at the end of the `with` block; if the block raises, nothing is sent. Wrong names and
    values raise InvalidInput immediately."""

    def __init__(self, editor: Editor) -> None:
        self._editor = editor
        self._entries: dict[int, Message] = {}
        self._attach: dict[int, int] = {}  # created object -> parent
        self._loose: set[int] = set()  # created without an explicit parent
        self.blobs = BlobHeap()
        self.committed: Committed | None = None  # set once the master has accepted it

    def set(self, target: Object | int | str, /, **values: Any) -> None:
        """Changes fields of an object, given as a value, by id or by path."""
        number, kind, message = self._open(target)
        entry = self._entries[number]
        for field, value in values.items():
            bit = kind.write(message, field, value, self.blobs)
            if entry.action == _UPDATE:
                entry.mask |= bit

    def create(self, kind: str | type[Object], /, *, parent: Object | int | str | None = "", **values: Any) -> Object:
        """Creates an object; omitted fields have defaults. Objects of the scene graph are attached to `parent`, by default to the
        root unless another object of this transaction refers to them; None = not attached."""
        of = KIND_OF_TYPE[kind] if isinstance(kind, type) else kind_named(kind)
        if of is KINDS[0]:
            raise InvalidInput("a scene has exactly one root")
        if parent not in ("", None) and not of.is_placed:
            raise InvalidInput(f"a {of.name} has no place in the graph: refer to it in a field instead")
        number = self._editor.new_id()
        message = of.default_message(number, self.blobs)
        for field, value in values.items():
            of.write(message, field, value, self.blobs)
        entry = self._entry(number, _CREATE)
        getattr(entry.object, of.name).CopyFrom(message)
        getattr(entry.object, of.name).SetInParent()
        if of.is_placed and parent == "":
            self._loose.add(number)
        elif of.is_placed and parent is not None:
            self._attach[number] = self._number(parent)
        return of.read(number, message)

    def remove(self, target: Object | int | str, /) -> None:
        """Removes an object. The master rejects this if other objects still refer to it."""
        number = self._number(target)
        if number == ROOT_ID:
            raise InvalidInput("the root cannot be removed")
        known = self._entries.get(number)
        if known is not None and known.action == _CREATE:
            del self._entries[number]
            self._attach.pop(number, None)
            self._loose.discard(number)
            return
        if known is not None and known.action == _REMOVE:
            raise InvalidInput(f"object {number} is removed in this transaction already")
        self._editor.mirror().entry(number)
        self._entry(number, _REMOVE)

    def attach(self, child: Object | int | str, parent: Object | int | str = ROOT_ID, /) -> None:
        """Adds to the current children of the root or of a transform."""
        number, children = self._number(child), self._children(parent)
        if number not in children:
            children.append(number)
        self.set(parent, children=children)
        self._loose.discard(number)

    def detach(self, child: Object | int | str, parent: Object | int | str = ROOT_ID, /) -> None:
        """Removes from the current children of the root or of a transform."""
        number = self._number(child)
        self.set(parent, children=[other for other in self._children(parent) if other != number])

    def entries(self) -> list[Message]:
        """The entries of the edit. Objects without an explicit parent are attached here, to the latest children."""
        referred = {child for entry in self._entries.values()
                    for parent in (entry.object.root, entry.object.transform) for child in parent.children}
        for number in sorted(self._loose - referred):
            self._attach[number] = ROOT_ID
        self._loose.clear()
        for number, parent in self._attach.items():
            self.attach(number, parent)
        self._attach.clear()
        return [entry for entry in self._entries.values() if entry.action != _UPDATE or entry.mask]

    def _children(self, parent: Object | int | str) -> list[int]:
        number, kind, message = self._open(parent)
        if "children" not in kind.codecs:
            raise InvalidInput(f"a {kind.name} has no children: give the root or a transform")
        entry = self._entries[number]
        if entry.action == _CREATE or entry.mask & kind.bit("children"):
            return list(message.children)
        return list(self._editor.mirror().entry(number)[1].children)

    def _number(self, target: Object | int | str) -> int:
        return self._editor.mirror().find(target) if isinstance(target, str) else object_id(target)

    def _open(self, target: Object | int | str) -> tuple[int, Kind, Message]:
        """The object's entry, created if necessary, and the message in it."""
        number = self._number(target)
        entry = self._entries.get(number)
        if entry is None:
            known = KIND_OF_TYPE.get(type(target)) if isinstance(target, Object) else None
            # A known object needs no round trip: a drag is sent without waiting for the previous edit.
            kind = known or self._editor.mirror().entry(number)[0]
            entry = self._entry(number, _UPDATE)
            getattr(entry.object, kind.name).SetInParent()
        elif entry.action == _REMOVE:
            raise InvalidInput(f"object {number} is removed in this transaction")
        word = entry.object.WhichOneof("kind")
        return number, kind_named(word), getattr(entry.object, word)

    def _entry(self, number: int, action: Any) -> Message:
        entry = scene_pb2.Entry(id=number, action=action)
        self._entries[number] = entry
        return entry

"""Edits that become one transaction: all of it, or nothing."""

from __future__ import annotations

from typing import Any, Protocol

from .blobs import BlobHeap
from .errors import InvalidInput
from .fields import KIND_OF_TYPE, KINDS, Kind, kind_named, object_id
from .mirror import Mirror
from .people import Committed
from .proto import scene_pb2
from .values import Object, ROOT_ID

Message = Any
_CREATE, _UPDATE, _REMOVE = scene_pb2.Entry.CREATE, scene_pb2.Entry.UPDATE, scene_pb2.Entry.REMOVE


class Editor(Protocol):
    """What a transaction needs of its session."""

    def mirror(self) -> Mirror:
        """The scene as it is now."""
        ...

    def new_id(self) -> int: ...


class Transaction:
    """Collects changes. Nothing reaches the master before the end of the `with` block, and nothing at all when the block
    raises. Wrong names and values raise InvalidInput at once."""

    def __init__(self, editor: Editor) -> None:
        self._editor = editor
        self._entries: dict[int, Message] = {}
        self._attach: dict[int, int] = {}  # created object -> parent
        self._loose: set[int] = set()  # created without a word about the parent
        self.blobs = BlobHeap()
        self.committed: Committed | None = None  # once the master has taken it

    def set(self, target: Object | int | str, /, **values: Any) -> None:
        """Changes fields of an object, which is given as such, by id or by path."""
        number, kind, message = self._open(target)
        entry = self._entries[number]
        for field, value in values.items():
            bit = kind.write(message, field, value, self.blobs)
            if entry.action == _UPDATE:
                entry.mask |= bit

    def create(self, kind: str | type[Object], /, *, parent: Object | int | str | None = "", **values: Any) -> Object:
        """A new object; what is not given has its default. What can be seen is attached to `parent`: the root, unless
        something else in this transaction refers to it; None = nowhere."""
        of = KIND_OF_TYPE[kind] if isinstance(kind, type) else kind_named(kind)
        if of is KINDS[0]:
            raise InvalidInput("a scene has one root, which is there already")
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
        """Takes an object away. What still refers to it keeps the master from accepting that."""
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
        """Adds to the children of the root or of a transform, as they are now."""
        number, children = self._number(child), self._children(parent)
        if number not in children:
            children.append(number)
        self.set(parent, children=children)
        self._loose.discard(number)

    def detach(self, child: Object | int | str, parent: Object | int | str = ROOT_ID, /) -> None:
        """Takes from the children of the root or of a transform, as they are now."""
        number = self._number(child)
        self.set(parent, children=[other for other in self._children(parent) if other != number])

    def entries(self) -> list[Message]:
        """What the edit holds. Objects without a place are attached now, to the latest children."""
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
        """The object's entry, made when it is not there yet, and the message in it."""
        number = self._number(target)
        entry = self._entries.get(number)
        if entry is None:
            known = KIND_OF_TYPE.get(type(target)) if isinstance(target, Object) else None
            # Who has the object need not wait until the latest edit can be read: a drag is sent as fast as it comes.
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

"""The encoding of the fields of each kind in messages, and their bits in field masks."""

from __future__ import annotations

import difflib
import math
import struct
from array import array
from dataclasses import dataclass
from typing import Any, Callable, Iterable, Mapping, Sequence

from .blobs import BlobSource
from .errors import InvalidInput, Malformed
from .objects import KIND_ROWS, TEXTURE_SLOT_ROWS, TextureSlot
from .proto import scene_pb2
from .values import Blob, FieldRow, Object

Message = Any  # of protobuf, which has no type hints in Debian


@dataclass(frozen=True)
class Codec:
    """One type of values: `write` checks and raises InvalidInput with what was expected, `read` raises Malformed."""

    write: Callable[[Message, str, Any, BlobSource], None]
    read: Callable[[Message, str], Any]


def _number(value: Any) -> float:
    if isinstance(value, bool) or not hasattr(value, "__float__"):
        raise InvalidInput("expected a number")
    number = float(value)
    if not math.isfinite(number):
        raise InvalidInput("expected a finite number")
    return number


def _float32(value: Any) -> float:
    number = _number(value)
    try:
        struct.pack("<f", number)
    except OverflowError:
        raise InvalidInput("the number is too large") from None
    return number


def _sequence(value: Any) -> Sequence[Any]:
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        raise InvalidInput("expected a list")
    return list(value)


def object_id(value: Any) -> int:
    """Of an object, an id or None."""
    if value is None:
        return 0
    if isinstance(value, Object):
        return value.id
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << 32:
        return value
    raise InvalidInput("expected an object, its id or None")


def _plain(convert: Callable[[Any], Any]) -> Codec:
    def write(message: Message, field: str, value: Any, _: BlobSource) -> None:
        setattr(message, field, convert(value))

    return Codec(write, lambda message, field: getattr(message, field))


def _boolean(value: Any) -> bool:
    if not isinstance(value, bool):
        raise InvalidInput("expected True or False")
    return value


def _signed(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not -(1 << 31) <= value < 1 << 31:
        raise InvalidInput("expected a whole number")
    return value


def _size(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 32:
        raise InvalidInput("expected a whole number from 0")
    return value


def _encoded(value: Any) -> bytes:
    if not isinstance(value, str):
        raise InvalidInput("expected a text")
    return value.encode("utf-8", "surrogateescape")


def _read_text(message: Message, field: str) -> str:
    return bytes(getattr(message, field)).decode("utf-8", "surrogateescape")


def _write_text(message: Message, field: str, value: Any, _: BlobSource) -> None:
    setattr(message, field, _encoded(value))


def _vector(length: int, convert: Callable[[Any], float]) -> Codec:
    def write(message: Message, field: str, value: Any, _: BlobSource) -> None:
        values = [convert(v) for v in _sequence(value)]
        if len(values) != length:
            raise InvalidInput(f"expected {length} numbers, not {len(values)}")
        message.ClearField(field)
        getattr(message, field).extend(values)

    def read(message: Message, field: str) -> tuple[float, ...]:
        values = tuple(getattr(message, field))
        if len(values) != length:
            raise Malformed(f"'{field}' has {len(values)} numbers instead of {length}")
        return values

    return Codec(write, read)


def _write_matrices(message: Message, field: str, value: Any, _: BlobSource) -> None:
    matrices = [[_number(v) for v in _sequence(matrix)] for matrix in _sequence(value)]
    if any(len(matrix) != 16 for matrix in matrices):
        raise InvalidInput("expected matrices of 16 numbers")
    message.ClearField(field)
    getattr(message, field).extend(v for matrix in matrices for v in matrix)


def _read_matrices(message: Message, field: str) -> tuple[tuple[float, ...], ...]:
    values = tuple(getattr(message, field))
    if len(values) % 16 != 0:
        raise Malformed(f"'{field}' has {len(values)} numbers, which is not a multiple of 16 (matrices)")
    return tuple(values[i:i + 16] for i in range(0, len(values), 16))


def _choice(*names: str) -> Codec:
    def write(message: Message, field: str, value: Any, _: BlobSource) -> None:
        if value not in names:
            raise InvalidInput(f"expected one of {', '.join(names)}")
        setattr(message, field, names.index(value))

    def read(message: Message, field: str) -> str:
        number: int = getattr(message, field)
        if number >= len(names):
            raise Malformed(f"'{field}' has an unknown value")
        return names[number]

    return Codec(write, read)


def _write_ids(message: Message, field: str, value: Any, _: BlobSource) -> None:
    ids = [object_id(v) for v in _sequence(value)]
    message.ClearField(field)
    getattr(message, field).extend(ids)


def blob_from(reference: Message) -> Blob:
    """Of a BlobRef. Raises Malformed."""
    if reference.byte_size == 0:
        return Blob()
    if len(reference.hash) != 32:
        raise Malformed("a hash does not have 32 bytes")
    return Blob(bytes(reference.hash), reference.byte_size)


def _blob(code: str) -> Codec:
    def write(message: Message, field: str, value: Any, blobs: BlobSource) -> None:
        blob = value if isinstance(value, Blob) else blobs.add(raw_array(value, code))
        target = getattr(message, field)
        target.hash, target.byte_size = blob.hash, blob.byte_size
        target.SetInParent()

    return Codec(write, lambda message, field: blob_from(getattr(message, field)))


def _blobs(code: str) -> Codec:
    def write(message: Message, field: str, value: Any, blobs: BlobSource) -> None:
        encoded = [v if isinstance(v, Blob) else blobs.add(raw_array(v, code)) for v in _sequence(value)]
        message.ClearField(field)
        for blob in encoded:
            getattr(message, field).add(hash=blob.hash, byte_size=blob.byte_size)

    return Codec(write, lambda message, field: tuple(map(blob_from, getattr(message, field))))


def raw_array(value: Any, code: str) -> bytes:
    """Little-endian bytes of an array: of bytes unchanged, from objects with a buffer (array, numpy), from nested lists.
    `code` is "f" (float32), "I" (uint32) or "B" (bytes)."""
    if value is None:
        return b""
    if isinstance(value, (bytes, bytearray)):
        return bytes(value)
    flat: list[Any] = []
    try:
        view = memoryview(value)
    except TypeError:
        _flatten(value, flat, 0)
    else:
        if view.format.lstrip("<=@") == code and view.contiguous:
            return view.tobytes("C")
        _flatten(view.tolist(), flat, 0)
    try:
        values = array(code, flat)
    except (TypeError, OverflowError, ValueError):
        raise InvalidInput({"f": "expected numbers", "I": "expected whole numbers from 0",
                            "B": "expected bytes"}[code]) from None
    return struct.pack(f"<{len(values)}{code}", *values)


def _flatten(value: Any, to: list[Any], depth: int) -> None:
    if isinstance(value, (str, bytes)) or depth > 4:
        raise InvalidInput("expected an array")
    if isinstance(value, Iterable):
        for part in value:
            _flatten(part, to, depth + 1)
    else:
        to.append(value)


def _write_slot(message: Message, field: str, value: Any, blobs: BlobSource) -> None:
    slot = value if isinstance(value, TextureSlot) else TextureSlot(object_id(value))
    target = getattr(message, field)
    target.Clear()
    target.SetInParent()
    for name, codec in _SLOT.items():
        codec.write(target, name, getattr(slot, name), blobs)


def _read_slot(message: Message, field: str) -> TextureSlot:
    slot = getattr(message, field)
    return TextureSlot(**{name: codec.read(slot, name) for name, codec in _SLOT.items()})


# By the words of the rows in `objects.py`.
_CODECS: Mapping[str, Codec] = {
    "text": Codec(_write_text, _read_text), "bool": _plain(_boolean), "int": _plain(_signed), "uint": _plain(_size),
    "float": _plain(_float32), "double": _plain(_number),
    "float2": _vector(2, _float32), "float3": _vector(3, _float32), "float4": _vector(4, _float32),
    "double3": _vector(3, _number), "matrix": _vector(16, _number), "matrices": Codec(_write_matrices, _read_matrices),
    "id": _plain(object_id), "ids": Codec(_write_ids, lambda message, field: tuple(getattr(message, field))),
    "slot": Codec(_write_slot, _read_slot),
    "blob I": _blob("I"), "blob f": _blob("f"), "blob B": _blob("B"), "blobs f": _blobs("f"),
}


def _codec(row: FieldRow) -> Codec:
    return _choice(*row.choices) if row.choices else _CODECS[row.codec]


_SLOT: Mapping[str, Codec] = {row.name: _codec(row) for row in TEXTURE_SLOT_ROWS}


@dataclass(frozen=True)
class Kind:
    """One kind of objects. `codecs` is in the order of the message's fields."""

    name: str  # as in messages
    plural: str  # as in paths
    type: type[Object]
    codecs: Mapping[str, Codec]
    bits: Mapping[str, int]  # of each field, in a mask
    is_placed: bool  # may be a child of the root or of a transform

    def bit(self, field: str) -> int:
        """Of this field's mask. Raises InvalidInput with the nearest name."""
        names = list(self.codecs)
        if field not in self.codecs:
            near = difflib.get_close_matches(field, names, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"it has {', '.join(names)}"
            raise InvalidInput(f"a {self.name} has no field '{field}': {hint}")
        return self.bits[field]

    def write(self, message: Message, field: str, value: Any, blobs: BlobSource) -> int:
        """Into a message of this kind; returns the field's bit."""
        bit = self.bit(field)
        try:
            self.codecs[field].write(message, field, value, blobs)
        except InvalidInput as error:
            raise InvalidInput(f"{self.name}.{field}: {error}") from None
        return bit

    def read(self, object_id: int, message: Message) -> Object:
        return self.type(object_id, **{name: codec.read(message, name) for name, codec in self.codecs.items()})

    def default_message(self, object_id: int, blobs: BlobSource) -> Message:
        message = getattr(scene_pb2, self.type.__name__)()
        default = self.type(object_id)
        for name in self.codecs:
            self.write(message, name, getattr(default, name), blobs)
        return message


# In the order of messages.
KINDS: tuple[Kind, ...] = tuple(
    Kind(kind.name, kind.plural, kind.type, {row.name: _codec(row) for row in kind.fields},
         {row.name: 1 << (row.number - 1) for row in kind.fields}, kind.is_placed) for kind in KIND_ROWS)
KIND_OF_TYPE: Mapping[type[Object], Kind] = {kind.type: kind for kind in KINDS}


def kind_named(word: str) -> Kind:
    """By "light" or "lights". Raises InvalidInput with the nearest name."""
    for kind in KINDS:
        if word in (kind.name, kind.plural):
            return kind
    near = difflib.get_close_matches(word, [kind.name for kind in KINDS], 1)
    hint = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(kind.name for kind in KINDS)}"
    raise InvalidInput(f"there is no kind of object called '{word}': {hint}")


def kind_in(holder: Message) -> tuple[Kind, Message]:
    """The kind of an Object message, and what it holds. Raises Malformed."""
    word = holder.WhichOneof("kind")
    if word is None:
        raise Malformed("an entry without an object")
    return kind_named(word), getattr(holder, word)

"""How the fields of each kind look in messages, and which bit of a mask each one is."""

from __future__ import annotations

import difflib
import math
import re
import struct
from array import array
from dataclasses import dataclass, fields
from typing import Any, Callable, Iterable, Mapping, Sequence

from .blobs import BlobSource
from .errors import InvalidInput, Malformed
from .objects import (Attachment, Background, Blob, Camera, Geometry, Light, Material, Medium, Object, Root,
                      SurfaceShader, Texture, TextureSlot, Transform)
from .proto import scene_pb2

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
        raise Malformed(f"'{field}' has {len(values)} numbers, which are no matrices of 16")
    return tuple(values[i:i + 16] for i in range(0, len(values), 16))


def _choice(*names: str) -> Codec:
    def write(message: Message, field: str, value: Any, _: BlobSource) -> None:
        if value not in names:
            raise InvalidInput(f"expected one of {', '.join(names)}")
        setattr(message, field, names.index(value))

    def read(message: Message, field: str) -> str:
        number: int = getattr(message, field)
        if number >= len(names):
            raise Malformed(f"'{field}' has a value that nobody knows")
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
        made = [v if isinstance(v, Blob) else blobs.add(raw_array(v, code)) for v in _sequence(value)]
        message.ClearField(field)
        for blob in made:
            getattr(message, field).add(hash=blob.hash, byte_size=blob.byte_size)

    return Codec(write, lambda message, field: tuple(map(blob_from, getattr(message, field))))


def raw_array(value: Any, code: str) -> bytes:
    """Little-endian bytes of an array: of bytes as they are, of what has a buffer (array, numpy), of nested lists.
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


_FLOAT = _plain(_float32)
_FLOAT2 = _vector(2, _float32)


def _write_slot(message: Message, field: str, value: Any, blobs: BlobSource) -> None:
    slot = value if isinstance(value, TextureSlot) else TextureSlot(object_id(value))
    target = getattr(message, field)
    target.Clear()
    target.SetInParent()
    target.texture = object_id(slot.texture)
    _FLOAT2.write(target, "offset", slot.offset, blobs)
    _FLOAT2.write(target, "scale", slot.scale, blobs)
    _FLOAT.write(target, "rotation", slot.rotation, blobs)
    _UINT.write(target, "set", slot.set, blobs)


def _read_slot(message: Message, field: str) -> TextureSlot:
    slot = getattr(message, field)
    return TextureSlot(slot.texture, _FLOAT2.read(slot, "offset"), _FLOAT2.read(slot, "scale"), slot.rotation,
                       slot.set)


_TEXT = Codec(_write_text, _read_text)
_DOUBLE, _BOOL, _UINT, _REF = _plain(_number), _plain(_boolean), _plain(_size), _plain(object_id)
_FLOAT3, _FLOAT4 = _vector(3, _float32), _vector(4, _float32)
_DOUBLE3, _MATRIX = _vector(3, _number), _vector(16, _number)
_IDS = Codec(_write_ids, lambda message, field: tuple(getattr(message, field)))
_SLOT = Codec(_write_slot, _read_slot)
_INT = _plain(_signed)
_HINT = _choice("unflagged", "static", "animated")
_WRAP = _choice("repeat", "mirror", "clamp")


@dataclass(frozen=True)
class Kind:
    """One kind of objects. The order of `codecs` is that of the bits of a mask."""

    name: str  # as in messages
    plural: str  # as in paths
    type: type[Object]
    codecs: Mapping[str, Codec]
    is_placed: bool  # may be a child of the root or of a transform

    def bit(self, field: str) -> int:
        """Of this field's mask. Raises InvalidInput with the nearest name."""
        names = list(self.codecs)
        if field not in self.codecs:
            near = difflib.get_close_matches(field, names, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"it has {', '.join(names)}"
            raise InvalidInput(f"a {self.name} has no field '{field}': {hint}")
        return 1 << names.index(field)

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


def _kind(plural: str, object_type: type[Object], is_placed: bool, **codecs: Codec) -> Kind:
    words = re.findall("[A-Z][a-z]*", object_type.__name__)
    kind = Kind("_".join(words).lower(), plural, object_type, {"name": _TEXT, **codecs}, is_placed)
    assert [f.name for f in fields(object_type)] == ["id", *kind.codecs]
    return kind


# In the order of ObjectKind.
KINDS: tuple[Kind, ...] = (
    _kind("root", Root, False, children=_IDS, background=_REF, render_origin=_DOUBLE3),
    _kind("transforms", Transform, True, matrix=_MATRIX, children=_IDS, hint=_HINT, layers=_UINT,
          motion=Codec(_write_matrices, _read_matrices)),
    _kind("geometries", Geometry, True, material=_REF, hint=_HINT, indices=_blob("I"), positions=_blob("f"),
          normals=_blob("f"), tangents=_blob("f"), tex_coords=_blob("f"), colors=_blob("f"),
          tex_coords_1=_blob("f"), medium=_REF, motion_positions=_blobs("f"), motion_normals=_blobs("f")),
    _kind("materials", Material, False, base_color=_FLOAT4, base_color_texture=_SLOT, metallic=_FLOAT,
          roughness=_FLOAT, metallic_roughness_texture=_SLOT, normal_texture=_SLOT, normal_scale=_FLOAT,
          emission=_FLOAT3, emission_texture=_SLOT, alpha_mode=_choice("opaque", "mask", "blend"),
          alpha_cutoff=_FLOAT, double_sided=_BOOL, unlit=_BOOL, index_of_refraction=_FLOAT, transmission=_FLOAT,
          transmission_texture=_SLOT, thickness=_FLOAT, attenuation_color=_FLOAT3, attenuation_distance=_FLOAT,
          specular=_FLOAT, specular_texture=_SLOT, specular_color=_FLOAT3, specular_color_texture=_SLOT,
          clearcoat=_FLOAT, clearcoat_texture=_SLOT, clearcoat_roughness=_FLOAT, clearcoat_roughness_texture=_SLOT,
          clearcoat_normal_texture=_SLOT, clearcoat_normal_scale=_FLOAT, sheen_color=_FLOAT3,
          sheen_color_texture=_SLOT, sheen_roughness=_FLOAT, sheen_roughness_texture=_SLOT, anisotropy=_FLOAT,
          anisotropy_rotation=_FLOAT, anisotropy_texture=_SLOT, iridescence=_FLOAT, iridescence_texture=_SLOT,
          iridescence_index_of_refraction=_FLOAT, iridescence_thickness_minimum=_FLOAT,
          iridescence_thickness_maximum=_FLOAT, iridescence_thickness_texture=_SLOT, shadow_catcher=_BOOL),
    _kind("textures", Texture, False, width=_UINT, height=_UINT, format=_choice("rgba8", "rgba8_srgb", "rgb_float"),
          wrap_s=_WRAP, wrap_t=_WRAP, filter=_choice("linear", "nearest"), texels=_blob("B"),
          depth=_UINT),
    _kind("lights", Light, True, kind=_choice("point", "spot", "directional", "sphere", "quad"), intensity=_FLOAT3,
          inner_cone_angle=_FLOAT, outer_cone_angle=_FLOAT, radius=_FLOAT, size=_FLOAT2, angle=_FLOAT),
    _kind("cameras", Camera, True, vertical_fov=_DOUBLE, aspect_ratio=_DOUBLE,
          projection=_choice("perspective", "orthographic"), orthographic_height=_DOUBLE, lens_radius=_DOUBLE,
          focus_distance=_DOUBLE, aperture=_choice("uniform", "gaussian")),
    _kind("backgrounds", Background, False, color=_FLOAT3, environment=_REF, strength=_FLOAT, rotation=_FLOAT,
          visible=_choice("environment", "color"), visible_color=_FLOAT4),
    _kind("attachments", Attachment, True, key=_TEXT, value=_TEXT),
    _kind("surface_shaders", SurfaceShader, False, emission=_FLOAT3, emission_texture=_SLOT, ambient=_FLOAT3,
          ambient_texture=_SLOT, diffuse=_FLOAT3, diffuse_texture=_SLOT, specular=_FLOAT3, specular_texture=_SLOT,
          shininess=_FLOAT2, shininess_texture=_SLOT, alpha=_FLOAT, alpha_texture=_SLOT, invert_alpha_texture=_BOOL,
          normal_texture=_SLOT, normal_format=_choice("unorm", "snorm"), normal_space=_choice("tangent", "object"),
          normal_scale=_FLOAT3, normal_bias=_FLOAT3, height_texture=_SLOT, height_scale=_FLOAT, reflection=_FLOAT3,
          reflection_texture=_SLOT, transmission=_FLOAT3, transmission_texture=_SLOT,
          relative_index_of_refraction=_FLOAT3, fresnel_blend=_FLOAT, tangent_tex_coords=_INT,
          binormal_tex_coords=_INT, environment=_FLOAT3, environment_texture=_SLOT),
    _kind("media", Medium, False, emission=_FLOAT3, emission_texture=_SLOT, absorption=_FLOAT3,
          absorption_texture=_SLOT, scattering=_FLOAT3, scattering_texture=_SLOT, anisotropy=_FLOAT, priority=_INT),
)
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
        raise Malformed("an entry lacks its object")
    return kind_named(word), getattr(holder, word)

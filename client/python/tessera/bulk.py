"""The bulk link: a fixed little-endian header, then raw data. Decoding accepts arbitrary bytes and raises Malformed."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

from .errors import Malformed
from .film import FilmTile, channels_known, plane_count

MAGIC = 0x31525354  # "TSR1"
MAX_CHUNK = 1 << 20
_MAX_PIXELS = 1 << 16
_MAX_EDGE = 65536
_HELLO, _REQUEST, _CHUNK, _ABSENT, _FILM, _TILE, _PICTURE = range(7)
_FRAME = 9


@dataclass(frozen=True)
class BulkHello:
    token: int


@dataclass(frozen=True)
class BlobRequest:
    hash: bytes
    offset: int


@dataclass(frozen=True)
class BlobChunk:
    hash: bytes
    total: int
    offset: int
    data: bytes


@dataclass(frozen=True)
class BlobAbsent:
    hash: bytes


@dataclass(frozen=True)
class FrameTile:
    frame: int
    index: int
    count: int
    film: FilmTile


@dataclass(frozen=True)
class PictureChunk:
    frame: int
    total: int
    offset: int
    data: bytes


@dataclass(frozen=True)
class FrameHeader:
    view: int
    frame: int
    epoch: int
    number: int
    revision: int
    scale: int
    width: int
    height: int
    components: int
    encoding: int
    picture_bytes: int
    film_x: int  # what the tiles cover
    film_y: int
    film_width: int
    film_height: int
    film_tiles: int
    complete: int
    min_samples: int
    max_samples: int
    spp: int
    film_hash: bytes
    mean_samples: float = 0.0
    noise: float = 0.0


BulkMessage = BulkHello | BlobRequest | BlobChunk | BlobAbsent | FrameTile | PictureChunk | FrameHeader

_HEAD = struct.Struct("<II")
_TOKEN = struct.Struct("<Q")
_BLOB_REQUEST = struct.Struct("<32sQ")
_BLOB_CHUNK = struct.Struct("<32sQQ")
_HASH = struct.Struct("<32s")
_TILE_HEAD = struct.Struct("<QII")
_PICTURE_CHUNK = struct.Struct("<QQQ")
_FRAME_HEADER = struct.Struct("<QQQQQIIIIIQiiiiIIQQQ32sdd")
_FILM_HEAD = struct.Struct("<iiiiQIIQB")
_UNIFORM_COUNTS = 1  # a flag


def encode(message: BulkMessage) -> bytes:
    """Encodes a message of a client, or of a master in a test."""
    match message:
        case BulkHello(token):
            return _HEAD.pack(MAGIC, _HELLO) + _TOKEN.pack(token)
        case BlobRequest(name, offset):
            return _HEAD.pack(MAGIC, _REQUEST) + _BLOB_REQUEST.pack(name, offset)
        case BlobChunk(name, total, offset, data):
            return _HEAD.pack(MAGIC, _CHUNK) + _BLOB_CHUNK.pack(name, total, offset) + data
        case BlobAbsent(name):
            return _HEAD.pack(MAGIC, _ABSENT) + _HASH.pack(name)
        case FrameTile(frame, index, count, film):
            return (_HEAD.pack(MAGIC, _TILE) + _TILE_HEAD.pack(frame, index, count) +
                    _FILM_HEAD.pack(film.x, film.y, film.width, film.height, 0, 0, film.channels, 0, 0) +
                    film.counts + film.planes)
        case PictureChunk(frame, total, offset, data):
            return _HEAD.pack(MAGIC, _PICTURE) + _PICTURE_CHUNK.pack(frame, total, offset) + data
        case FrameHeader():
            return _HEAD.pack(MAGIC, _FRAME) + _FRAME_HEADER.pack(
                message.view, message.frame, message.epoch, message.number, message.revision, message.scale,
                message.width, message.height, message.components, message.encoding, message.picture_bytes,
                message.film_x, message.film_y, message.film_width, message.film_height, message.film_tiles, message.complete, message.min_samples, message.max_samples, message.spp,
                message.film_hash, message.mean_samples, message.noise)


def decode(data: bytes) -> BulkMessage:
    """One message. Sizes are checked before anything is stored."""
    if len(data) < _HEAD.size:
        raise Malformed("not a bulk message")
    magic, kind = _HEAD.unpack_from(data)
    if magic != MAGIC:
        raise Malformed("not a bulk message")
    payload = memoryview(data)[_HEAD.size:]
    if kind == _HELLO:
        return BulkHello(*_whole(_TOKEN, payload))
    if kind == _REQUEST:
        return BlobRequest(*_whole(_BLOB_REQUEST, payload))
    if kind == _CHUNK:
        name, total, offset = _front(_BLOB_CHUNK, payload)
        return BlobChunk(name, total, offset, _piece(payload[_BLOB_CHUNK.size:], total, offset))
    if kind == _ABSENT:
        return BlobAbsent(*_whole(_HASH, payload))
    if kind == _TILE:
        frame, index, count = _front(_TILE_HEAD, payload)
        if index >= count:
            raise Malformed("a tile's index is not below the tile count")
        return FrameTile(frame, index, count, _film(payload[_TILE_HEAD.size:]))
    if kind == _PICTURE:
        frame, total, offset = _front(_PICTURE_CHUNK, payload)
        return PictureChunk(frame, total, offset, _piece(payload[_PICTURE_CHUNK.size:], total, offset))
    if kind == _FRAME:
        header = FrameHeader(*_whole(_FRAME_HEADER, payload))
        if not (header.mean_samples >= 0.0 and header.noise >= 0.0):
            raise Malformed("a number of samples or a noise that is no number")
        if header.scale == 0 or header.encoding >= len(ENCODINGS):
            raise Malformed("a frame's scale or encoding is unknown")
        if header.width > _MAX_EDGE or header.height > _MAX_EDGE or header.components > 4:
            raise Malformed("a frame's size is absurd")
        return header
    raise Malformed("a bulk message that masters do not send to clients")


ENCODINGS = ("none", "planes", "png", "jpeg", "exr")  # by their number on the wire


def _front(layout: struct.Struct, payload: memoryview) -> tuple[Any, ...]:
    if len(payload) < layout.size:
        raise Malformed("it ends too early")
    return layout.unpack_from(payload)


def _whole(layout: struct.Struct, payload: memoryview) -> tuple[Any, ...]:
    if len(payload) != layout.size:
        raise Malformed("its length does not match its kind")
    return layout.unpack(payload)


def _piece(data: memoryview, total: int, offset: int) -> bytes:
    if len(data) > MAX_CHUNK or offset > total or len(data) > total - offset:
        raise Malformed("a chunk extends beyond the total size")
    return bytes(data)


def _film(payload: memoryview) -> FilmTile:
    if len(payload) < _FILM_HEAD.size:
        raise Malformed("it ends too early")
    x, y, width, height, _, level, channels, _, flags = _FILM_HEAD.unpack_from(payload)
    if not (0 < width <= _MAX_EDGE and 0 < height <= _MAX_EDGE and 0 <= x <= _MAX_EDGE and 0 <= y <= _MAX_EDGE and
            width * height <= _MAX_PIXELS):
        raise Malformed("the tile's size is absurd")
    if channels == 0 or not channels_known(channels):
        raise Malformed("a channel is unknown")
    if level >= 32:
        raise Malformed("a block of samples is too large")
    if flags not in (0, _UNIFORM_COUNTS):
        raise Malformed("it has unknown flags, or not all pixels of its tile")
    pixels = width * height
    rest = payload[_FILM_HEAD.size:]
    count_bytes = 4 if flags == _UNIFORM_COUNTS else 4 * pixels
    if len(rest) != count_bytes + 4 * pixels * plane_count(channels):
        raise Malformed("the planes have another size than the header says")
    counts = bytes(rest[:count_bytes])
    return FilmTile(x, y, width, height, channels, counts * pixels if flags == _UNIFORM_COUNTS else counts,
                    bytes(rest[count_bytes:]))

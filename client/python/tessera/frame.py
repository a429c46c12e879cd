"""Frames of a view, and their assembly from bulk messages."""

from __future__ import annotations

import os
from array import array
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import bulk
from .errors import InvalidInput, Malformed
from .film import Film, FilmTile, floats
from .mirror import Version
from .old_names import SampleCountNames

_MAX_PICTURE = 1 << 30
_SUFFIXES = {"png": (".png",), "jpeg": (".jpg", ".jpeg"), "exr": (".exr",)}


@dataclass(frozen=True)
class Frame(SampleCountNames):
    """One picture of a view."""

    number: int  # counts from 1
    version: Version  # of the scene
    revision: int  # of the view: grows with every change of its camera
    scale: int  # 8, 4, 2: a coarse picture of this part of the view's size
    width: int
    height: int
    min_samples: int  # of a pixel
    max_samples: int
    spp: int  # target samples per pixel
    complete: bool
    film_hash: bytes  # when complete
    encoding: str  # "png", "jpeg", "exr", "planes", "none"
    components: int
    data: bytes = field(repr=False)  # the file, or the float32 planes one after another
    tiles: tuple[FilmTile, ...] = field(default=(), repr=False)
    mean_samples: float = 0.0  # per pixel
    noise: float = 0.0  # of the samples at the last decision: the root of relMSE; 0 = unknown

    def planes(self) -> list["array[float]"]:
        """The filtered float32 picture, one array for each component in raster order; of picture="planes"."""
        if self.encoding != "planes":
            raise InvalidInput(f"this frame is {self.encoding}: open the view with picture=\"planes\"")
        size = 4 * self.width * self.height
        return [floats(self.data[i * size:(i + 1) * size]) for i in range(self.components)]

    def numpy(self) -> Any:
        """The same as an array of height x width x components; needs numpy."""
        import numpy  # an optional dependency

        planes = [numpy.frombuffer(plane, dtype=numpy.float32) for plane in self.planes()]
        return numpy.stack(planes, axis=-1).reshape(self.height, self.width, self.components)

    def film(self) -> Film:
        """The statistics; of film=True."""
        if not self.tiles:
            raise InvalidInput("this frame has no statistics: open the view with film=True")
        film = Film(self.width, self.height, self.tiles[0].channels)
        for tile in self.tiles:
            film.paste(tile)
        return film

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the encoded picture to a file; the extension must match the encoding."""
        if self.encoding not in _SUFFIXES:
            raise InvalidInput(f"this frame is {self.encoding}, not a file: open the view with picture=\"png\"")
        if Path(path).suffix.lower() not in _SUFFIXES[self.encoding]:
            raise InvalidInput(f"'{path}' does not end in {_SUFFIXES[self.encoding][0]}, but the frame is "
                               f"{self.encoding}: choose another name, or open the view with another picture=")
        Path(path).write_bytes(self.data)


@dataclass
class Assembly:
    """A frame being received. Memory grows with the received data only."""

    header: bulk.FrameHeader
    largest: tuple[int, int] | None  # the view's size, where it is known
    last_activity: float
    picture: bytearray = field(default_factory=bytearray)
    tiles: dict[int, FilmTile] = field(default_factory=dict)

    def __post_init__(self) -> None:
        header = self.header
        if header.picture_bytes > _MAX_PICTURE:
            raise Malformed("a picture of more than 1 GiB")
        if self.largest is not None and (header.width > self.largest[0] or header.height > self.largest[1]):
            raise Malformed("a frame is larger than its view")
        if header.film_tiles > header.width * header.height:
            raise Malformed("a frame of more tiles than pixels")
        if bulk.ENCODINGS[header.encoding] == "planes" and (
                header.picture_bytes != 4 * header.width * header.height * header.components):
            raise Malformed("planes of another size than the frame")

    @property
    def is_done(self) -> bool:
        return len(self.picture) == self.header.picture_bytes and len(self.tiles) == self.header.film_tiles

    def add(self, part: bulk.PictureChunk | bulk.FrameTile, now: float) -> None:
        """Raises Malformed for what does not fit."""
        if isinstance(part, bulk.PictureChunk):
            if part.total != self.header.picture_bytes or part.offset != len(self.picture):
                raise Malformed("a part of a picture that does not match its frame")
            self.picture += part.data
        else:
            film = part.film
            if part.count != self.header.film_tiles or film.x + film.width > self.header.width or (
                    film.y + film.height > self.header.height):
                raise Malformed("a tile does not fit its frame")
            if any(tile.channels != film.channels for tile in self.tiles.values()):
                raise Malformed("tiles of one frame have different channels")
            self.tiles[part.index] = film
        self.last_activity = now

    def frame(self) -> Frame:
        h = self.header
        return Frame(h.frame, (h.epoch, h.number), h.revision, h.scale, h.width, h.height, h.min_samples,
                     h.max_samples, h.spp, bool(h.complete), h.film_hash if h.complete else b"",
                     bulk.ENCODINGS[h.encoding], h.components, bytes(self.picture),
                     tuple(self.tiles[i] for i in sorted(self.tiles)), h.mean_samples, h.noise)

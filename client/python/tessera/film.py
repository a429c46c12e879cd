"""The film of a picture: counts and float32 planes. See mediator/frame/channels.h."""

from __future__ import annotations

import sys
from array import array
from dataclasses import dataclass
from enum import Enum

from .channels import CHANNEL_ROWS
from .errors import InvalidInput, Malformed


class Rule(Enum):
    """The merge rule of a channel, which determines its planes."""

    MOMENTS = "moments"  # means, then sums of squared deviations
    SUM = "sum"
    MINIMUM = "minimum"
    MAXIMUM = "maximum"
    NEAREST = "nearest"  # the key, then the value
    FIRST = "first"
    BLOCK_VARIANCE = "block_variance"  # squared half difference of the two halves, and the mean of those of the halves
    FIRST_HALF = "first_half"  # means of the first half of the samples, and their count


# By their number on the wire: name, rule, components.
CHANNELS: tuple[tuple[str, Rule, int], ...] = tuple((name, Rule(rule), n) for name, rule, n in CHANNEL_ROWS)


def channel_bits(names: tuple[str, ...] | list[str]) -> int:
    """The set of these channels. Raises InvalidInput for an unknown one."""
    known = [name for name, _, _ in CHANNELS]
    bits = 0
    for name in names:
        if name not in known:
            raise InvalidInput(f"there is no channel '{name}': choose of {', '.join(known)}")
        bits |= 1 << known.index(name)
    return bits


def channels_known(bits: int) -> bool:
    return bits >> len(CHANNELS) == 0


def _planes_of(rule: Rule, components: int) -> int:
    return 2 * components if rule is Rule.MOMENTS else components


def plane_count(bits: int) -> int:
    return sum(_planes_of(rule, components) for i, (_, rule, components) in enumerate(CHANNELS) if bits >> i & 1)


def floats(data: bytes | bytearray | memoryview) -> "array[float]":
    """Little-endian float32, as numbers."""
    values: array[float] = array("f")
    values.frombytes(data)
    if sys.byteorder == "big":
        values.byteswap()
    return values


def _counts(data: bytearray) -> "array[int]":
    values: array[int] = array("I")
    values.frombytes(data)
    if sys.byteorder == "big":
        values.byteswap()
    return values


@dataclass(frozen=True)
class FilmTile:
    """A rectangle of the film: uint32 counts and float32 planes one after another, little-endian."""

    x: int
    y: int
    width: int
    height: int
    channels: int
    counts: bytes
    planes: bytes


class Film:
    """The whole picture's statistics, in raster order. Pixels without samples have count 0."""

    def __init__(self, width: int, height: int, channels: int) -> None:
        self.width = width
        self.height = height
        self._channels = channels
        self._counts = bytearray(4 * width * height)
        self._planes = [bytearray(4 * width * height) for _ in range(plane_count(channels))]

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of its channels."""
        return tuple(name for i, (name, _, _) in enumerate(CHANNELS) if self._channels >> i & 1)

    @property
    def counts(self) -> "array[int]":
        """Accepted samples of each pixel."""
        return _counts(self._counts)

    def planes(self, channel: str) -> list["array[float]"]:
        """The planes of a channel as they are merged: of moments the means and then the sums of squared deviations
        (variance of the mean = that / (n (n - 1))), of sums the sums (mean = that / n)."""
        first = 0
        for i, (name, rule, components) in enumerate(CHANNELS):
            if not self._channels >> i & 1:
                continue
            count = _planes_of(rule, components)
            if name == channel:
                return [floats(plane) for plane in self._planes[first:first + count]]
            first += count
        raise InvalidInput(f"this film has no channel '{channel}': it has {', '.join(self.channels)}")

    def paste(self, tile: FilmTile) -> None:
        """Copies a tile to its position. Raises Malformed if it does not fit."""
        if tile.channels != self._channels or tile.x + tile.width > self.width or tile.y + tile.height > self.height:
            raise Malformed("a tile does not fit its picture")
        row, pixels = 4 * tile.width, 4 * tile.width * tile.height
        for y in range(tile.height):
            to = 4 * ((tile.y + y) * self.width + tile.x)
            self._counts[to:to + row] = tile.counts[y * row:(y + 1) * row]
            for i, plane in enumerate(self._planes):
                plane[to:to + row] = tile.planes[i * pixels + y * row:i * pixels + (y + 1) * row]

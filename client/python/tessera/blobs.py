"""Blobs: immutable bytes named by their BLAKE2b-256. Served to the master on request, fetched in chunks."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import Protocol

from . import bulk
from .errors import Malformed
from .values import Blob

CHUNK_BYTES = 256 << 10  # that the master serves before it turns to others
IN_FLIGHT = 32  # chunks requested and not yet received
RETRY_SECONDS = 3.0


def digest(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=32).digest()


class BlobSource(Protocol):
    """Stores bytes that an edit refers to."""

    def add(self, data: bytes) -> Blob: ...


class BlobHeap:
    """Bytes by hash, of an edit being submitted."""

    def __init__(self) -> None:
        self.blobs: dict[bytes, bytes] = {}

    def add(self, data: bytes) -> Blob:
        if not data:
            return Blob()
        name = digest(data)
        self.blobs[name] = data
        return Blob(name, len(data))


def answer(request: bulk.BlobRequest, data: bytes | None) -> bulk.BulkMessage:
    """The reply to a request: the requested range, or that the blob is absent."""
    if data is None or request.offset > len(data):
        return bulk.BlobAbsent(request.hash)
    piece = data[request.offset:request.offset + CHUNK_BYTES]
    return bulk.BlobChunk(request.hash, len(data), request.offset, piece)


@dataclass
class Fetch:
    """The download of one blob. No I/O: gets the received chunks and times, returns the requests to send."""

    blob: Blob
    data: bytearray = field(default_factory=bytearray)
    requested: int = 0  # end of the requested ranges
    last_activity: float = 0.0
    absent: bool = False

    @property
    def is_done(self) -> bool:
        return len(self.data) == self.blob.byte_size

    def due(self, now: float) -> list[bulk.BlobRequest]:
        """The requests to send now: the next ranges and, after a timeout, all unanswered ones."""
        if self.absent or self.is_done:
            return []
        if self.requested > len(self.data) and now - self.last_activity > RETRY_SECONDS:
            self.requested = len(self.data)
        requests = []
        while self.requested < min(self.blob.byte_size, len(self.data) + IN_FLIGHT * CHUNK_BYTES):
            requests.append(bulk.BlobRequest(self.blob.hash, self.requested))
            self.requested = min(self.blob.byte_size, self.requested + CHUNK_BYTES)
            self.last_activity = now
        return requests

    def receive(self, chunk: bulk.BlobChunk, now: float) -> None:
        """Raises Malformed for another size than announced, and for a wrong hash, after which it starts again."""
        if chunk.total != self.blob.byte_size:
            raise Malformed("a blob of another size than announced")
        self.last_activity = now
        if chunk.offset != len(self.data):  # early ones are requested again, late ones are duplicates
            self.requested = min(self.requested, len(self.data)) if chunk.offset > len(self.data) else self.requested
            return
        self.data += chunk.data
        self.requested = max(self.requested, len(self.data))
        if self.is_done and digest(bytes(self.data)) != self.blob.hash:
            self.data, self.requested = bytearray(), 0
            raise Malformed("a blob has the wrong hash")

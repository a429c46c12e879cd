#!/usr/bin/env python3
"""Mutated messages at the decoders of the Python package: they are decoded, or Malformed is raised, and nothing else.

Usage: decoders_test.py [--inputs N] [--seed N]
"""

import argparse
import contextlib
import itertools
import random
import sys
import time
import unittest

import tessera
from tessera import bulk
from tessera.fields import KINDS
from tessera.film import Film
from tessera.frame import Assembly
from tessera.mirror import Mirror
from tessera.parsing import parsed
from tessera.proto import control_pb2, scene_pb2

OPTIONS = argparse.Namespace(inputs=20000, seed=1)
MAX_DEPTH = 4  # of nested messages
MAX_MUTATIONS = 4
SLOWEST = 2.0  # s for one input of at most 64 KiB; a busy machine may stop this process that long


class Inputs:
    """Mutants of valid messages, from a seed."""

    def __init__(self, valid):
        self._valid, self._draw = valid, random.Random(OPTIONS.seed)

    def __iter__(self):
        return itertools.islice(iter(self._next, None), OPTIONS.inputs)

    def _next(self):
        data = bytearray(self._draw.choice(self._valid))
        for _ in range(self._draw.randint(0, MAX_MUTATIONS)):
            self._draw.choice((self._flip, self._set, self._insert, self._erase, self._repeat, self._splice, self._number))(data)
        return bytes(data[:65536])

    def _place(self, data):
        return self._draw.randrange(len(data) + 1)

    def _range(self, data):
        begin = self._place(data)
        return begin, min(len(data), begin + self._draw.choice((1, 2, 4, 8, 64, 4096)))

    def _flip(self, data):
        if data:
            data[self._draw.randrange(len(data))] ^= 1 << self._draw.randrange(8)

    def _set(self, data):
        if data:
            data[self._draw.randrange(len(data))] = self._draw.choice((0, 1, 0x7F, 0x80, 0xFF))

    def _insert(self, data):
        at = self._place(data)
        data[at:at] = self._draw.randbytes(self._draw.choice((1, 2, 4, 16)))

    def _erase(self, data):
        begin, end = self._range(data)
        del data[begin:end]

    def _repeat(self, data):
        begin, end = self._range(data)
        data[begin:begin] = data[begin:end]

    def _splice(self, data):
        other = self._draw.choice(self._valid)
        begin, end = self._range(other)
        at = self._place(data)
        data[at:at] = other[begin:end]

    def _number(self, data):
        """A length, a size or a count that is extreme."""
        size = self._draw.choice((4, 8))
        if len(data) >= size:
            at = self._draw.randrange(len(data) - size + 1)
            value = self._draw.choice((0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1, 2**64 - 1)) & (256**size - 1)
            data[at:at + size] = value.to_bytes(size, "little")


def fill(message, draw, depth=0):
    """Fields of the message at random, with values of their types."""
    for field in message.DESCRIPTOR.fields:
        if draw.random() < 0.3:
            continue
        if field.type == field.TYPE_MESSAGE:
            if depth == MAX_DEPTH:
                continue
            repeated = field.label == field.LABEL_REPEATED
            for _ in range(draw.randint(1, 3) if repeated else 1):
                inner = getattr(message, field.name)
                inner = inner.add() if repeated else inner
                inner.SetInParent()
                fill(inner, draw, depth + 1)
            continue
        value = some_value(field, draw)
        if field.label == field.LABEL_REPEATED:
            getattr(message, field.name).extend([value] * draw.randint(1, 16))
        else:
            setattr(message, field.name, value)
    return message


def some_value(field, draw):
    kind = field.cpp_type
    if kind in (field.CPPTYPE_FLOAT, field.CPPTYPE_DOUBLE):
        return draw.choice((0.0, 0.5, -1.0, 1e30, float("nan"), float("inf")))
    if kind == field.CPPTYPE_BOOL:
        return draw.random() < 0.5
    if kind == field.CPPTYPE_STRING:
        return bytes(draw.randbytes(4)) if field.type == field.TYPE_BYTES else "text"
    if kind == field.CPPTYPE_ENUM:
        return draw.choice(field.enum_type.values).number
    return draw.choice((0, 1, 2, 7, 64, 2**31 - 1))


def control_messages():
    draw = random.Random(OPTIONS.seed)
    messages = []
    for field in control_pb2.Control.DESCRIPTOR.fields:
        for _ in range(3):
            control = control_pb2.Control()
            inner = getattr(control, field.name)
            inner.SetInParent()
            fill(inner, draw)
            messages.append(control.SerializeToString())
    return messages


def change_lists():
    """Snapshots of objects of every kind, and changes that are based on them."""
    draw = random.Random(OPTIONS.seed)
    lists = []
    for _ in range(8):
        snapshot = scene_pb2.ChangeList()
        snapshot.to.epoch, snapshot.to.number = 1, 1
        for number, field in enumerate(scene_pb2.Object.DESCRIPTOR.fields):
            entry = snapshot.entries.add(id=number + 1, action=scene_pb2.Entry.CREATE)
            inner = getattr(entry.object, field.name)
            inner.SetInParent()
            if draw.random() < 0.7:
                fill(inner, draw)
        lists.append(snapshot.SerializeToString())
        update = scene_pb2.ChangeList()
        getattr(update, "from").CopyFrom(snapshot.to)
        update.to.epoch, update.to.number = 1, 2
        for entry in snapshot.entries:
            change = update.entries.add(id=entry.id, action=draw.choice((scene_pb2.Entry.UPDATE, scene_pb2.Entry.REMOVE)),
                                        mask=draw.choice((0, 1, 3, 7)))
            change.object.CopyFrom(entry.object)
        lists.append(update.SerializeToString())
    return lists


def bulk_messages():
    tile = tessera.film.FilmTile(1, 0, 2, 2, 1, bytes(range(16)), bytes(4 * 4 * 6))
    header = bulk.FrameHeader(1, 1, 7, 1, 1, 1, 8, 4, 3, 1, 384, 0, 0, 8, 4, 1, 1, 1, 1, 1, bytes(32))
    return [bulk.encode(message) for message in (
        bulk.BulkHello(5), bulk.BlobRequest(bytes(32), 9), bulk.BlobChunk(bytes(32), 10, 2, b"abc"), bulk.BlobAbsent(bytes(32)),
        bulk.FrameTile(1, 0, 1, tile), bulk.PictureChunk(1, 384, 0, bytes(96)), header)]


class Decoders(unittest.TestCase):
    def run_all(self, valid, decode):
        """decode: of bytes; raises Malformed."""
        decoded = 0
        for data in Inputs(valid):
            begin = time.process_time()
            try:
                decode(data)
                decoded += 1
            except tessera.Malformed:
                pass
            except Exception:
                print(f"input: {data.hex()}", file=sys.stderr)
                raise
            self.assertLess(time.process_time() - begin, SLOWEST, data.hex())
        self.assertGreater(decoded, OPTIONS.inputs // 20, "too few mutants are still messages")
        self.assertLess(decoded, OPTIONS.inputs)

    def test_bulk(self):
        def decode(data):
            message = bulk.decode(data)
            self.assertEqual(bulk.decode(bulk.encode(message)), message)
            if isinstance(message, bulk.FrameTile):
                film = Film(message.film.x + message.film.width, message.film.y + message.film.height, message.film.channels)
                film.paste(message.film)
                self.assertEqual(len(film.counts), film.width * film.height)

        self.run_all(bulk_messages(), decode)

    def test_frames_are_assembled(self):
        header = bulk.decode(bulk_messages()[-1])
        assembly = Assembly(header, None, 0.0)

        def decode(data):
            nonlocal assembly
            message = bulk.decode(data)
            if isinstance(message, bulk.FrameHeader):
                assembly = Assembly(message, None, 0.0)
            elif isinstance(message, (bulk.PictureChunk, bulk.FrameTile)):
                assembly.add(message, 1.0)
            if assembly.is_done and assembly.header.width * assembly.header.height <= 1 << 16:
                frame = assembly.frame()
                if frame.tiles:
                    frame.film()

        self.run_all(bulk_messages(), decode)

    def test_control(self):
        self.run_all(control_messages(), lambda data: parsed(control_pb2.Control, data))

    def test_change_lists(self):
        mirror = Mirror()

        def decode(data):
            changes = parsed(scene_pb2.ChangeList, data)
            mirror.apply(changes)
            for object_id in mirror.ids():
                mirror.path(object_id)
                with contextlib.suppress(tessera.Malformed):  # values that the master would have refused
                    mirror.value(object_id)
            for kind in KINDS:
                list(mirror.of_kind(kind))

        self.run_all(change_lists(), decode)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=OPTIONS.inputs, help=f"for each decoder ({OPTIONS.inputs})")
    parser.add_argument("--seed", type=int, default=OPTIONS.seed, help=f"of the mutations ({OPTIONS.seed})")
    parser.parse_args(namespace=OPTIONS)
    unittest.main(argv=sys.argv[:1], warnings="ignore")

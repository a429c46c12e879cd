"""What a session is told about others, about the past and about the cluster; values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .mirror import Version

Message = Any


def text(data: bytes) -> str:
    """Texts of the wire are UTF-8 by custom, not by check."""
    return bytes(data).decode("utf-8", "replace")


@dataclass(frozen=True)
class Person:
    session: int
    name: str
    user: str  # of the key
    text: str  # what they say that they do
    selection: tuple[int, ...]
    is_editor: bool
    clock_offset_seconds: float  # their clock less the master's, +- bound
    clock_bound_seconds: float


@dataclass(frozen=True)
class Lock:
    object: int
    name: str  # of the member that holds it


@dataclass(frozen=True)
class ViewSummary:
    name: str
    owner: str
    width: int
    height: int
    samples: int
    spp: int
    watchers: int


@dataclass(frozen=True)
class People:
    title: str
    people: tuple[Person, ...]
    locks: tuple[Lock, ...]
    views: tuple[ViewSummary, ...]


@dataclass(frozen=True)
class HistoryEntry:
    number: int
    name: str
    user: str
    time: float  # seconds since 1970
    edits: int
    text: str
    undoes: int  # another's number, 0 = none
    undone_by: int


@dataclass(frozen=True)
class Writer:
    transaction: int
    name: str
    user: str
    time: float  # seconds since 1970


@dataclass(frozen=True)
class Committed:
    """An edit that was accepted."""

    transaction: int
    version: Version  # that holds it, or will when it is published
    notes: tuple[str, ...] = ()  # of an undo: what was left as later edits made it


@dataclass(frozen=True)
class Hit:
    object: int  # the geometry
    position: tuple[float, ...]  # world
    normal: tuple[float, ...]  # shading normal, world
    distance: float  # from the eye


@dataclass(frozen=True)
class NodeState:
    name: str
    host: str
    backend: str
    phase: str
    version: Version
    units_in_hand: int
    samples_per_second: float
    round_trip_seconds: float
    stuck: bool
    clock_offset_seconds: float  # its clock less the master's, +- bound; bound 0 = not known yet
    clock_bound_seconds: float


@dataclass(frozen=True)
class Status:
    software: str
    version: Version
    uptime_seconds: float
    sessions: int
    queued: int
    scene: str  # title of the live scene, "" = none
    members: int
    nodes: tuple[NodeState, ...]


_PHASES = ("idle", "syncing", "building", "rendering", "leaving")


def people_of(message: Message) -> People:
    return People(
        text(message.title),
        tuple(Person(p.session, text(p.name), text(p.user), text(p.text), tuple(p.selection), p.editor,
                     p.clock_offset_seconds, p.clock_bound_seconds) for p in message.people),
        tuple(Lock(lock.object, text(lock.name)) for lock in message.locks),
        tuple(ViewSummary(text(v.name), text(v.owner), v.width, v.height, v.samples, v.spp, v.watchers)
              for v in message.views))


def history_of(message: Message) -> list[HistoryEntry]:
    return [HistoryEntry(t.number, text(t.name), text(t.user), t.time * 1e-9, t.edits, text(t.text), t.undoes,
                        t.undone_by) for t in message.transactions]


def status_of(message: Message) -> Status:
    return Status(
        text(message.software), (message.version.epoch, message.version.number), message.uptime_seconds,
        message.sessions, message.queued, text(message.live.title), message.live.members,
        tuple(NodeState(text(n.summary.name), text(n.summary.host), text(n.summary.backend),
                        _PHASES[n.phase] if n.phase < len(_PHASES) else "unknown",
                        (n.version.epoch, n.version.number), n.units_in_hand, n.samples_per_second,
                        n.round_trip_seconds, n.stuck, n.clock_offset_seconds, n.clock_bound_seconds)
              for n in message.nodes))

"""Value types about members, history, views and the cluster."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .mirror import Version
from .old_names import MembersNames, NodeStateNames, SampleCountNames

Message = Any


def text(data: bytes) -> str:
    """Decodes a text of the protocol, which should be UTF-8 but is not validated."""
    return bytes(data).decode("utf-8", "replace")


@dataclass(frozen=True)
class Member:
    session: int
    name: str
    user: str  # of the key
    text: str  # status text set by the member
    selection: tuple[int, ...]
    is_editor: bool
    clock_offset_seconds: float  # offset of their clock from the master's, +- bound
    clock_bound_seconds: float


@dataclass(frozen=True)
class Lock:
    object: int
    name: str  # of the member that holds it


@dataclass(frozen=True)
class ViewEntry:
    name: str
    owner: str
    width: int
    height: int
    samples: int
    spp: int
    watchers: int
    noise: float = 0.0  # as in Progress


@dataclass(frozen=True)
class Members(MembersNames):
    title: str
    members: tuple[Member, ...]
    locks: tuple[Lock, ...]
    views: tuple[ViewEntry, ...]


@dataclass(frozen=True)
class HistoryEntry:
    number: int
    name: str
    user: str
    time: float  # seconds since 1970
    edits: int
    text: str
    undoes: int  # number of the undone transaction, 0 = none
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
    version: Version  # the version that contains it, once published
    notes: tuple[str, ...] = ()  # of an undo: fields kept because of later edits


@dataclass(frozen=True)
class Hit:
    object: int  # the geometry
    position: tuple[float, ...]  # world
    normal: tuple[float, ...]  # shading normal, world
    distance: float  # from the camera
    name: str = ""  # of the geometry


@dataclass(frozen=True)
class NodeState(NodeStateNames):
    name: str
    host: str
    backend: str
    phase: str
    version: Version
    units_in_flight: int
    samples_per_second: float
    round_trip_seconds: float
    stuck: bool
    clock_offset_seconds: float  # offset of its clock from the master's, +- bound; bound 0 = not known yet
    clock_bound_seconds: float


@dataclass(frozen=True)
class Status:
    software: str
    version: Version
    uptime_seconds: float
    sessions: int
    queued: int
    scene: str  # title of the open scene, "" = none
    members: int
    nodes: tuple[NodeState, ...]


@dataclass(frozen=True)
class Progress:
    """Progress of a view."""

    phase: str  # "waiting_for_nodes", "syncing", "rendering", "delivering", "filtering"
    samples: int  # of pixels
    samples_expected: int
    rays: int
    nodes: int
    seconds: float  # since rendering began
    noise: float  # of a picture that stops at a noise, at the last decision; 0 = unknown
    error: float = 0.0  # likewise, of one that stops at an error


@dataclass(frozen=True)
class FailedTile:
    """A tile of the picture that no node could render, or only with fewer samples."""

    x: int  # pixels of the picture
    y: int
    width: int
    height: int
    samples: int  # per pixel that it has
    message: str  # the failure, with the command that replays it


@dataclass(frozen=True)
class Summary(SampleCountNames):
    """Result of a view that has ended."""

    outcome: str  # "complete", "incomplete" (see failed_tiles), "time_up", "stopped", "no_nodes", "failed"
    message: str  # the reason, unless complete
    version: Version
    seconds_render: float
    rays: int
    samples: int  # of all pixels
    min_samples: int  # per pixel; with a picture
    max_samples: int
    nodes: tuple[str, ...]  # names of the nodes that rendered
    filter: str  # name and parameters, as executed
    notes: tuple[str, ...]  # about the picture
    failed_tiles: tuple[FailedTile, ...] = ()  # the first ones
    noise: float = 0.0  # as in Progress
    error: float = 0.0  # likewise


_VIEW_PHASES = ("waiting_for_nodes", "syncing", "rendering", "delivering", "filtering")
_OUTCOMES = ("complete", "time_up", "stopped", "no_nodes", "failed", "incomplete")
_PHASES = ("idle", "syncing", "building", "rendering", "leaving")


def members_of(answer: Message) -> Members:
    message = answer.content
    return Members(
        text(message.title),
        tuple(Member(p.session, text(p.name), text(p.user), text(p.text), tuple(p.selection), p.editor,
                     p.clock_offset_seconds, p.clock_bound_seconds) for p in message.members),
        tuple(Lock(lock.object, text(lock.name)) for lock in message.locks),
        tuple(ViewEntry(text(v.name), text(v.owner), v.width, v.height, v.samples, v.spp, v.watchers, v.noise)
              for v in message.views))


def history_of(message: Message) -> list[HistoryEntry]:
    return [HistoryEntry(t.number, text(t.name), text(t.user), t.time * 1e-9, t.edits, text(t.text), t.undoes,
                        t.undone_by) for t in message.transactions]


def status_of(answer: Message) -> Status:
    message = answer.status
    return Status(
        text(message.software), (message.version.epoch, message.version.number), message.uptime_seconds,
        message.sessions, message.queued, text(message.scene.title), message.scene.members,
        tuple(NodeState(text(n.summary.name), text(n.summary.host), text(n.summary.backend),
                        _PHASES[n.phase] if n.phase < len(_PHASES) else "unknown",
                        (n.version.epoch, n.version.number), n.units_in_flight, n.samples_per_second,
                        n.round_trip_seconds, n.stuck, n.clock_offset_seconds, n.clock_bound_seconds)
              for n in message.nodes))


def progress_of(message: Message) -> Progress:
    phase = _VIEW_PHASES[message.phase] if message.phase < len(_VIEW_PHASES) else "unknown"
    return Progress(phase, message.samples, message.samples_expected, message.rays, message.nodes,
                    message.elapsed * 1e-9, message.noise, message.error)


def summary_of(message: Message) -> Summary:
    outcome = _OUTCOMES[message.outcome] if message.outcome < len(_OUTCOMES) else "unknown"
    return Summary(outcome, text(message.message), (message.version.epoch, message.version.number),
                   message.seconds_render, message.rays, message.samples, message.min_samples, message.max_samples,
                   tuple(text(node.name) for node in message.nodes), text(message.picture.filter),
                   tuple(text(note) for note in message.picture.notes),
                   tuple(FailedTile(tile.rect.x, tile.rect.y, tile.rect.width, tile.rect.height, tile.samples, text(tile.message))
                         for tile in message.failed_tiles), message.noise, message.error)

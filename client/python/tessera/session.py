"""One client of a master: a member of its scene."""

from __future__ import annotations

import logging
import threading
import time
from contextlib import AbstractContextManager, contextmanager
from typing import Any, Callable, Iterable, Iterator, Sequence

from . import bulk, camera, display
from .blobs import BlobHeap
from .connection import Connection, lock_request
from .errors import Error, InvalidInput, Malformed, Refused, Unavailable
from .fields import blob_from, object_id
from .link import CONTROL_LIMIT
from .mirror import Mirror, Version
from .objects import Camera
from .parsing import parsed
from .proto import control_pb2, scene_pb2
from .old_names import SessionNames, edit_group_of
from .records import (Committed, HistoryEntry, Members, Progress, Status, Writer, history_of, members_of, status_of,
                      text)
from .scene import Scene
from .transaction import Transaction
from .values import Blob, Object
from .view import ALL_LAYERS, LAST_FRAME_ONLY, LIVE_FILTER, MAX_SPP, VIEW_TRANSFORMS, CameraLike, Rendered, View, plain_view

Message = Any
_LOG = logging.getLogger("tessera")
_UNDO_LATEST, _REDO_LATEST = (1 << 64) - 1, (1 << 64) - 2
_PUBLISH_TIMEOUT = 30.0  # seconds


class Session(SessionNames):
    """Created by `connect`. A background thread maintains the connection: the caller may sleep, compute or stop in a debugger.
    Calls block until the master has answered and are thread-safe; a transaction belongs to one thread. Short interruptions,
    and a master restarted with its journal, are recovered: see Connection. All methods raise Unavailable if the master does
    not answer, Refused if it rejects a request, and InvalidInput for invalid arguments."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self._editing = threading.RLock()  # one edit or read of the scene at a time; protects the members below
        self._mirror = Mirror()
        self._committed: Version = (0, 0)  # contains all edits of this session
        self._last_sequence = self._next_id = 0
        self._joins_seen = 0
        self._last_view = self._last_edit_group = 0

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Disconnects; the scene stays on the master. Idempotent."""
        self.connection.close()

    # ---- the scene ----

    def join(self, title: str = "", *, exclusive: bool = False, no_wait: bool = False,
             timeout: float | None = None) -> Scene:
        """Joins the live scene, or opens one called `title` if there is none. An exclusive scene belongs to this session only
        and is closed with it. Waits while another scene is open that cannot be joined; with `no_wait` raises Refused
        instead."""
        self.connection.join(title, exclusive, no_wait, timeout)
        return Scene(self)

    @property
    def title(self) -> str:
        """The title of the scene; an existing scene keeps its title."""
        joined = self.connection.joined
        return text(joined.title) if joined is not None else ""

    @property
    def name(self) -> str:
        """The name of this member as others see it; the master may have made it unique."""
        joined = self.connection.joined
        return text(joined.name) if joined is not None else self.connection.name

    def transaction(self, *, edit_group: int = 0, **old: int) -> AbstractContextManager[Transaction]:
        """with session.transaction() as edit: ... - committed atomically at the end of the block. Consecutive transactions with
        the same edit group (see `new_edit_group`) are undone together. Raises Refused with the master's reasons."""
        return self._transaction(edit_group_of(edit_group, old))

    @contextmanager
    def _transaction(self, edit_group: int) -> Iterator[Transaction]:
        self.connection.require_joined()
        edit = Transaction(self)
        yield edit
        with self._editing:
            entries = edit.entries()
            if entries:
                edit.committed = self._commit(entries, edit.blobs, edit_group=edit_group)

    def new_edit_group(self) -> int:
        """A new edit group, e.g. for one mouse drag: its transactions are undone together."""
        with self._editing:
            self._last_edit_group += 1
            return self._last_edit_group

    def undo(self, transaction: int | None = None) -> Committed:
        """Undoes a transaction, by default this member's latest. Fields changed by others since are kept and listed in notes."""
        return self._commit([], BlobHeap(), undo=_UNDO_LATEST if transaction is None else transaction)

    def redo(self) -> Committed:
        """Reverts this member's latest undo."""
        return self._commit([], BlobHeap(), undo=_REDO_LATEST)

    def _commit(self, entries: Sequence[Message], blobs: BlobHeap, *, edit_group: int = 0, undo: int = 0) -> Committed:
        self.connection.require_joined()
        with self._editing:
            self._follow_joins()
            self._last_sequence += 1
            sequence, submitted_at, base = self._last_sequence, time.monotonic_ns(), self._mirror.version

            def build() -> Message:
                edit = scene_pb2.Edit(session=self.connection.number, sequence=sequence, edit_group=edit_group, undo=undo,
                                      submitted_at=submitted_at, entries=entries)
                edit.base.epoch, edit.base.number = base
                return _edit_request(edit, blobs)

            reply = self.connection.ask(("edit", sequence), "edit_reply", build, None, blobs)
            self.connection.answered = sequence
            result = reply.result
            if not result.accepted:
                raise Refused([text(problem) for problem in result.problems])
            self._committed = (result.version.epoch, result.version.number)
            return Committed(result.transaction, self._committed, tuple(text(note) for note in result.notes))

    def _follow_joins(self) -> None:
        """Applies the latest SceneJoined: ids, sequence number, and the scene version after a restart."""
        with self.connection.changed:
            joined, joins = self.connection.joined, self.connection.joins
        if joined is None or joins == self._joins_seen:
            return
        self._joins_seen = joins
        if not joined.first_id <= self._next_id <= joined.first_id + joined.id_count:
            self._next_id = joined.first_id
        self._last_sequence = max(self._last_sequence, joined.last_sequence)
        version = (joined.version.epoch, joined.version.number)
        if version[0] != self._committed[0]:
            self._committed = version

    def new_id(self) -> int:
        """An unused id for a new object."""
        self.connection.require_joined()
        with self._editing:
            self._follow_joins()
            if self._mirror.version == (0, 0):
                self.refresh()
            joined = self.connection.joined
            while self._next_id in self._mirror:
                self._next_id += 1  # used by an earlier session of the same editor
            if joined is None or self._next_id >= joined.first_id + joined.id_count:
                raise Unavailable("all object ids allocated to this session are used: reconnect")
            self._next_id += 1
            return self._next_id - 1

    def mirror(self) -> Mirror:
        """The mirror, with at least all commits of this session. Other threads may refresh it: use it within `reading`."""
        self.connection.require_joined()
        with self._editing:
            self._follow_joins()
            deadline = time.monotonic() + _PUBLISH_TIMEOUT
            while self._mirror.version[0] != self._committed[0] or not self.shows_all(self._mirror.version):
                self.refresh()
                if self.shows_all(self._mirror.version):
                    break
                if time.monotonic() > deadline:
                    raise Unavailable("the master does not publish what it has accepted")
                time.sleep(0.005)
            return self._mirror

    @contextmanager
    def reading(self) -> Iterator[Mirror]:
        with self._editing:
            yield self.mirror()

    def shows_all(self, version: Version) -> bool:
        """Whether this version contains all commits of this session."""
        return version[0] != self._committed[0] or version[1] >= self._committed[1]

    def refresh(self) -> Mirror:
        """Fetches the changes since the last refresh."""
        self.connection.require_joined()
        with self._editing:
            try:
                self._read_changes()
            except Malformed as error:
                _LOG.warning("the mirror is out of sync, requesting a snapshot: %s", error)
                self._read_changes()
            return self._mirror

    def _read_changes(self) -> None:
        request = control_pb2.Control()
        request.read_scene.known.epoch, request.read_scene.known.number = self._mirror.version
        content = self.connection.request(request)
        changes = content.list
        if content.blob.byte_size:
            changes = parsed(scene_pb2.ChangeList, self.connection.fetch(blob_from(content.blob)))
        self._mirror.apply(changes)

    def fetch(self, blob: Blob) -> bytes:
        """Fetches a blob from the master. Raises Unavailable if it does not have it."""
        return self.connection.fetch(blob)

    # ---- other members ----

    def lock(self, objects: Iterable[Object | int]) -> None:
        """Locks these objects against edits by others, until `unlock` or the end of this session."""
        ids = [object_id(o) for o in objects]
        self.connection.request(lock_request(ids, release=False))
        with self.connection.changed:
            self.connection.locks |= set(ids)

    def unlock(self, objects: Iterable[Object | int]) -> None:
        """Releases locks of this session."""
        ids = [object_id(o) for o in objects]
        self.connection.request(lock_request(ids, release=True))
        with self.connection.changed:
            self.connection.locks -= set(ids)

    def set_presence(self, what: str, selection: Iterable[Object | int] = (), seconds: float = 30.0) -> None:
        """Sets the status text and selection that others see; expires after `seconds`."""
        self.connection.require_joined()
        message = control_pb2.Control()
        message.set_presence.text = what.encode("utf-8", "surrogateescape")
        message.set_presence.selection.extend(object_id(o) for o in selection)
        message.set_presence.time_to_live = int(seconds * 1e9)
        self.connection.post(message)

    def members(self) -> Members:
        """The members of the scene, their locks, and the views that can be watched."""
        request = control_pb2.Control()
        request.read_members.SetInParent()
        return members_of(self.connection.request(request))

    def history(self, count: int = 20) -> list[HistoryEntry]:
        """The latest transactions, newest first."""
        request = control_pb2.Control()
        request.read_history.count = count
        return history_of(self.connection.request(request))

    def writers(self, of: Object | int) -> dict[str, Writer]:
        """The last writer of each field of an object; fields never edited are omitted."""
        request = control_pb2.Control()
        request.read_writers.object = object_id(of)
        with self.reading() as mirror:
            names = list(mirror.entry(object_id(of))[0].codecs)
        return {names[w.field]: Writer(w.transaction, text(w.name), text(w.user), w.time * 1e-9)
                for w in self.connection.request(request).fields if w.field < len(names)}

    def status(self) -> Status:
        """The status of the cluster. Works without a scene."""
        request = control_pb2.Control()
        request.status_request.SetInParent()
        reply = self.connection.ask("status", "status_reply", lambda: request, 60.0)
        page = reply
        while page.more and page.status.nodes:  # hundreds of nodes come in pages
            request.status_request.after = page.status.nodes[-1].summary.id
            page = self.connection.ask("status", "status_reply", lambda: request, 60.0)
            reply.status.nodes.extend(page.status.nodes)
        return status_of(reply)

    def close_scene(self) -> None:
        """Closes the scene and its views for all members."""
        request = control_pb2.Control()
        request.close_scene.SetInParent()
        self.connection.request(request)
        self.connection.leave_scene()

    # ---- the display ----

    def move_head(self, position: Sequence[float], orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0)) -> None:
        """Sets the tracked head in display space: position in metres; orientation (w, x, y, z), not zero, the identity looks
        along -z. The latest value is used; call this at the rate of the tracker: it does not wait, and is dropped while
        disconnected. If an eye cannot see a screen, that screen keeps the last valid position."""
        self.connection.require_joined()
        self.connection.post(display.move_head(position, orientation))

    def adjust_display(self, *, eye_separation: float | None = None, zero_parallax: float | None = None,
                       exposure: float | None = None, pattern: bool | None = None,
                       shown_layers: Iterable[int] | None = None) -> None:
        """Changes the given settings on all outputs at once: eye separation in metres; distance of zero parallax from the head in
        metres (0 = on the screens); exposure in stops; test pattern instead of the scene; visible compositing layers,
        counted from 0 in the order of the display file. Raises Refused while no display is open."""
        self.connection.request(display.adjustment(eye_separation, zero_parallax, exposure, pattern, shown_layers))

    # ---- views ----

    def open_view(self, at: CameraLike, *, size: tuple[int, int] = (1280, 720), spp: int | None = None, picture: str = "png",
                  film: bool = False, name: str = "", filter: str | None = None, renderer: str = "path", bounces: int = 8,
                  seed: int = 0, channels: Sequence[str] = ("radiance",), layers: int = ALL_LAYERS,
                  clamp: float | None = None, sky_sampling: str = "visible", budget: float | None = None,
                  exposure: float | None = None, view_transform: str = "neutral", adaptive: bool = True) -> View:
        """A view from a camera of the scene (the object or its path) or a Pose (`look_at`). `picture`: "png", "jpeg", "exr",
        "planes" (filtered float32) or "none"; `film`: also deliver the statistics of `channels`. `layers`: a mask, bit i is
        object layer i; other objects are invisible. `clamp`: most that a path adds to a sample after its second bounce, which
        makes the picture too dark (biased); None: no limit. `sky_sampling`: light samples of the sky where surfaces in the
        picture see it, "visible", or by its luminance alone, "luminance". `filter`: the denoiser; None: "psvgf" for "png" and "jpeg"
        without `film`, else none. `budget`: time in seconds for samples, filter and encoding
        together; `spp` is 64 by default, and without limit with a budget: the mean of all pixels, which get the samples that
        they need. Not `adaptive`: all pixels have as many. `exposure` of "png" and "jpeg" in EV, None:
        measured once, on the first picture; `view_transform`: "neutral", "agx", "reinhard" or "linear"."""
        if filter is None:
            filter = LIVE_FILTER if picture in ("png", "jpeg") and not film else ""
        view = plain_view(size, channels=channels, renderer=renderer, bounces=bounces, seed=seed, filter=filter,
                          layers=layers, clamp=clamp, sky_sampling=sky_sampling)
        self.aim(view, at)
        if spp is None:
            spp = 64 if budget is None else MAX_SPP
        request = self._request(view, spp, picture, film, name, budget, exposure, view_transform)
        request.wanted.stop.uniform = not adaptive
        return self._open(request)

    def render(self, at: CameraLike, *, size: tuple[int, int] = (1280, 720), spp: int | None = None, picture: str = "png",
               film: bool = False, filter: str = "", renderer: str = "path", bounces: int = 8, seed: int = 0,
               channels: Sequence[str] = ("radiance",), layers: int = ALL_LAYERS, clamp: float | None = None,
               sky_sampling: str = "visible", budget: float | None = None, exposure: float | None = None, view_transform: str = "neutral",
               min_nodes: int = 1, wait: float = 60.0, noise: float | None = None,
               error: float | None = None, adaptive: bool = True,
               on_progress: Callable[[Progress], None] | None = None) -> Rendered:
        """Renders one picture (arguments as in `open_view`) and returns its last frame and summary. Starts when `min_nodes` are
        ready, and gives up after `wait` seconds without nodes (outcome "no_nodes"). Calls `on_progress` with the progress.

        `spp` is 64 by default; with `budget` alone there is no limit, and pixels get the samples that they need. With `noise`
        they get them until the picture's relative error (root of relMSE, before the denoiser) is estimated to be that small: 0.02
        is a clean picture. With `error` instead, until the picture that `filter` makes has this relMSE, by the master's estimate.
        `spp` (of any pixel, 65536 by default) and `budget` are upper bounds then. Not `adaptive`: all pixels get as many
        samples."""
        view = plain_view(size, channels=channels, renderer=renderer, bounces=bounces, seed=seed, filter=filter,
                          layers=layers, clamp=clamp, sky_sampling=sky_sampling)
        self.aim(view, at)
        if noise is not None and error is not None:
            raise InvalidInput("noise and error exclude each other: leave one out")
        has_goal = noise is not None or error is not None
        ends_by_spp = not has_goal and (spp is not None or budget is None)
        if spp is None:
            spp = 65536 if has_goal else 64 if budget is None else MAX_SPP
        request = self._request(view, spp, picture, film, "", budget, exposure, view_transform)
        for goal, value in (("noise", noise), ("error", error)):
            if value is not None:
                if not 0.0 < value <= 1.0:
                    raise InvalidInput(f"{goal}: {value} is not above 0 and up to 1")
                setattr(request.wanted.stop, goal, value)
        request.wanted.stop.uniform = ends_by_spp or not adaptive
        request.wanted.frames, request.wanted.min_nodes = LAST_FRAME_ONLY, min_nodes
        request.wanted.wait_limit = int(wait * 1e9)
        opened = self._open(request)
        try:
            return opened.wait_for_end(on_progress)
        finally:
            opened.close()

    def watch(self, name: str, *, picture: str = "png", film: bool = False, exposure: float | None = None,
              view_transform: str = "neutral") -> View:
        """Watches the view with this name of another member (see `members`), with its camera."""
        view = plain_view((1, 1), channels=("radiance",), renderer="path", bounces=8, seed=0, filter="",
                          layers=ALL_LAYERS)
        self.aim(view, camera.look_at((0, 0, 1), (0, 0, 0)))
        request = self._request(view, 1, picture, film, name, None, exposure, view_transform)
        request.share = True
        return self._open(request)

    def set_filter(self, filter: str, view: str = "") -> str:
        """Changes the filter of the view with this name; without a name, of the only view that this key may change. Returns a
        description of the effect. The view of another key is for operators: others get `Refused`."""
        request = control_pb2.Control()
        request.set_view_filter.view, request.set_view_filter.filter = view.encode(), filter.encode()
        return text(self.connection.request(request).text)

    def _request(self, view: Message, spp: int, picture: str, film: bool, name: str, budget: float | None,
                 exposure: float | None, view_transform: str) -> Message:
        if picture not in bulk.ENCODINGS:
            raise InvalidInput(f"unknown picture encoding '{picture}': choose of {', '.join(bulk.ENCODINGS)}")
        if view_transform not in VIEW_TRANSFORMS:
            raise InvalidInput(f"there is no view transform '{view_transform}': choose of {', '.join(VIEW_TRANSFORMS)}")
        request = control_pb2.Control().request_view
        wanted = request.wanted
        wanted.display_transform.view_transform = VIEW_TRANSFORMS.index(view_transform)
        if exposure is not None:
            wanted.display_transform.exposure = exposure
        wanted.name, wanted.stop.spp, wanted.picture, wanted.film = name.encode(), spp, bulk.ENCODINGS.index(picture), film
        if budget is not None:
            wanted.stop.budget = int(budget * 1e9)
        wanted.view.CopyFrom(view)
        return request

    def _open(self, request: Message) -> View:
        with self.connection.changed:
            self._last_view += 1
            request.number = self._last_view
            opened = View(self, request)
            self.connection.views[opened.number] = opened
        try:
            opened.open()
        except Error:
            self.forget_view(opened)
            raise
        return opened

    def aim(self, view: Message, at: CameraLike) -> None:
        """Fills in camera and frustum of a View message."""
        if not isinstance(at, camera.Pose):
            with self.reading() as mirror:
                found = mirror.value(mirror.find(at) if isinstance(at, str) else at.id)
                if not isinstance(found, Camera):
                    raise InvalidInput(f"{mirror.path(found.id)} is not a camera")
                at = camera.Pose(camera.rigid(mirror.world_matrix(found.id)), found.vertical_fov, found.projection,
                                 found.orthographic_height, found.lens_radius, found.focus_distance, found.aperture,
                                 tuple(camera.rigid(step) for step in mirror.world_motion(found.id)))
        for field, values in (("world_from_camera", at.world_from_camera),
                              ("camera_motion", [number for step in at.motion for number in step]),
                              ("frustum", at.frustum(view.width, view.height))):
            view.ClearField(field)
            getattr(view, field).extend(values)
        view.projection = camera.PROJECTIONS.index(at.projection)
        view.lens_radius = at.lens_radius
        view.focus_distance = at.focus_distance
        view.aperture = camera.APERTURES.index(at.aperture)

    def forget_view(self, view: View) -> None:
        with self.connection.changed:
            self.connection.views.pop(view.number, None)
            self.connection.changed.notify_all()
        message = control_pb2.Control()
        message.end_view.number = view.number
        self.connection.post(message)


def _edit_request(edit: Message, blobs: BlobHeap) -> Message:
    """The edit as a message, or as a blob if it is too long for one."""
    request = control_pb2.Control()
    request.submit_edit.edit.CopyFrom(edit)
    if request.ByteSize() <= CONTROL_LIMIT:
        return request
    blob = blobs.add(edit.SerializeToString())
    request.Clear()
    by_blob = request.submit_edit_by_blob
    by_blob.session, by_blob.sequence = edit.session, edit.sequence
    by_blob.base.CopyFrom(edit.base)
    by_blob.blob.hash, by_blob.blob.byte_size = blob.hash, blob.byte_size
    return request

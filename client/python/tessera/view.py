"""Progressively refined views of the scene."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Sequence

from . import bulk, camera
from .errors import InvalidInput, Malformed, Refused, Unavailable
from .film import channel_bits
from .frame import Assembly, Frame
from .objects import Camera
from .proto import control_pb2, work_pb2
from .records import Hit, Progress, Summary, progress_of, summary_of, text

if TYPE_CHECKING:
    from .session import Session

Message = Any
CameraLike = camera.Pose | Camera | str
ALL_LAYERS = 0xFFFFFFFF
RENDERERS = ("path", "whitted", "raster", "coverage")
VIEW_TRANSFORMS = ("neutral", "agx", "reinhard", "linear")
LIVE_FILTER = "psvgf"  # that of `tessera watch`
MAX_SPP = 1 << 31
LAST_FRAME_ONLY = 1  # of the frames of a view, by its number on the wire
STALL_SECONDS = 5.0  # without further parts of a frame: the rest was lost


@dataclass(frozen=True)
class Rendered:
    """The result of a finished view: its last frame and summary."""

    frame: Frame
    summary: Summary


class View:
    """One view of this session. At most one frame is in flight and one is buffered, so a slow client does not block
    others. Waiting takes the buffered frame and lets the master send the next one."""

    def __init__(self, session: Session, request: Message) -> None:
        self._session, self._connection = session, session.connection
        self.number: int = request.number
        self._request = request
        self._assembly: Assembly | None = None
        self._waiting: Frame | None = None
        self._seen_revision = 0  # of the latest frame received
        self._revision = 1  # expected by waits: incremented with every change that the master accepts
        self._progress: Progress | None = None
        self._end: tuple[int, Summary] | None = None  # with the number of the last frame
        self.is_open = True

    @property
    def size(self) -> tuple[int, int]:
        return self._request.wanted.view.width, self._request.wanted.view.height

    def look(self, at: CameraLike) -> None:
        """Changes the camera. Later waits ignore frames from the old one."""
        view = work_pb2.View()
        view.CopyFrom(self._request.wanted.view)
        self._session.aim(view, at)
        self._replace(view, self._request.wanted.stop.spp)

    def change(self, *, size: tuple[int, int] | None = None, spp: int | None = None) -> None:
        """Changes the size or quality."""
        view = work_pb2.View()
        view.CopyFrom(self._request.wanted.view)
        if size is not None:
            pose_height = view.frustum[3] - view.frustum[2]
            set_size(view, size)
            if view.HasField("sky_cells_from"):
                _sample_visible_sky(view)
            half = 0.5 * pose_height * size[0] / size[1]
            view.frustum[0], view.frustum[1] = -half, half
        self._replace(view, self._request.wanted.stop.spp if spp is None else spp)

    def _replace(self, view: Message, spp: int) -> None:
        self._require_open()
        if view == self._request.wanted.view and spp == self._request.wanted.stop.spp:
            return
        with self._connection.changed:
            before = work_pb2.View()
            before.CopyFrom(self._request.wanted.view)
            revision, samples = self._revision, self._request.wanted.stop.spp
            self._revision = max(self._revision, self._seen_revision) + 1
            self._request.wanted.view.CopyFrom(view)
            self._request.wanted.stop.spp = spp
        try:
            self.open()
        except Refused:  # the master keeps the old settings
            with self._connection.changed:
                self._revision, self._request.wanted.stop.spp = revision, samples
                self._request.wanted.view.CopyFrom(before)
            raise

    def wait(self, samples: int = 1, timeout: float = 60.0) -> Frame:
        """Waits for a frame with all edits of this session and the current camera, with at least `samples` samples per pixel
        in the mean (or complete); 0 also accepts coarse pictures. Raises Unavailable at the timeout."""
        deadline = time.monotonic() + timeout
        while True:
            frame = self.next_frame(max(0.0, deadline - time.monotonic()))
            if frame is None:
                raise Unavailable(f"no picture with {samples} samples after {timeout:g} s: is a node connected?")
            fresh = frame.revision >= self._revision and self._session.shows_all(frame.version)
            full = samples == 0 or (frame.scale == 1 and max(frame.mean_samples, frame.min_samples) >= samples)
            if fresh and (full or frame.complete):
                return frame

    def next_frame(self, timeout: float) -> Frame | None:
        """The newest frame, each returned once; None if there is none within the timeout."""
        self._require_open()
        deadline = time.monotonic() + timeout
        with self._connection.changed:
            self._connection.wait_until(lambda: self._waiting is not None or not self.is_open, deadline)
            frame, self._waiting = self._waiting, None
        if frame is not None:
            self._acknowledge(frame.number)
        return frame

    def pick(self, x: int, y: int) -> Hit | None:
        """The object visible at the center of a pixel; None for the background."""
        self._require_open()
        if not (0 <= x < self.size[0] and 0 <= y < self.size[1]):
            raise InvalidInput(f"pixel {x},{y} is outside of the view's {self.size[0]}x{self.size[1]}")
        request = control_pb2.Control()
        request.pick.number, request.pick.x, request.pick.y = self.number, x, y
        picked = self._connection.request(request)
        if picked.problem:
            raise Refused(text(picked.problem))
        seen = picked.result
        if not seen.hit:
            return None
        return Hit(seen.object, tuple(seen.position), tuple(seen.normal), seen.distance, text(seen.name))

    def stop(self) -> None:
        """Stops rendering; the last frame has the samples merged so far."""
        self._require_open()
        message = control_pb2.Control()
        message.end_view.number, message.end_view.deliver = self.number, True
        self._connection.post(message)

    def wait_for_end(self, on_progress: Callable[[Progress], None] | None = None,
                     timeout: float | None = None) -> Rendered:
        """Waits for the end of the view and returns its last frame. Raises Unavailable at the timeout."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            self._require_open()
            with self._connection.changed:
                self._connection.wait_until(self._has_news, deadline)
                progress, self._progress = self._progress, None
                frame, end = self._waiting, self._end
                if frame is not None and frame.complete and end is None:
                    frame = None  # it may be the last: the summary has not arrived yet
                elif frame is not None:
                    self._waiting = None
            if progress is not None and on_progress is not None:
                on_progress(progress)
            if frame is not None:
                self._acknowledge(frame.number)
                if end is not None and frame.number == end[0]:
                    return Rendered(frame, end[1])
            if deadline is not None and time.monotonic() >= deadline:
                raise Unavailable(f"the view has not ended after {timeout:g} s: is a node connected?")

    def _has_news(self) -> bool:
        frame = self._waiting
        return (not self.is_open or self._progress is not None or
                (frame is not None and (not frame.complete or self._end is not None)))

    def close(self) -> None:
        """Closes the view on the master. Idempotent."""
        if self.is_open:
            self.is_open = False
            self._session.forget_view(self)

    def _require_open(self) -> None:
        if not self.is_open:
            raise InvalidInput("this view is closed: open another one")

    def open(self) -> None:
        """Sends the view's current settings to the master and waits for its confirmation."""
        request = control_pb2.Control()
        request.request_view.CopyFrom(self._request)
        self._connection.request(request)

    # The methods below are called by the session, with its lock held, on the link's thread.

    def reopened(self) -> Message:
        """The request to resend to a master that may have lost messages."""
        self._pass_over()  # a resumed session may be sending the frame: it waits until it is acknowledged
        self._end = None
        self._seen_revision, self._revision = 0, 1  # a restarted master restarts its numbers
        request = control_pb2.Control()
        request.request_view.CopyFrom(self._request)
        request.request_view.request = 0
        return request

    def progressed(self, progress: Message) -> None:
        self._progress = progress_of(progress)

    def ended(self, done: Message) -> None:
        self._end = (done.frame, summary_of(done.summary))

    def began(self, header: bulk.FrameHeader, now: float) -> None:
        """Raises Malformed; the frame is then skipped."""
        self._assembly = None
        try:
            self._assembly = Assembly(header, None if self._request.share else self.size, now)
        except Malformed:
            self._acknowledge(header.frame)
            raise
        self._finish_if_done()

    def awaits(self, part: bulk.PictureChunk | bulk.FrameTile) -> bool:
        return self._assembly is not None and self._assembly.header.frame == part.frame

    def add(self, part: bulk.PictureChunk | bulk.FrameTile, now: float) -> None:
        """Raises Malformed; the frame is then skipped."""
        assert self._assembly is not None
        try:
            self._assembly.add(part, now)
        except Malformed:
            self._pass_over()
            raise
        self._finish_if_done()

    def tick(self, now: float) -> None:
        if self._assembly is not None and now - self._assembly.last_activity > STALL_SECONDS:
            self._pass_over()

    def _pass_over(self) -> None:
        if self._assembly is not None:
            self._acknowledge(self._assembly.header.frame)
            self._assembly = None

    def _finish_if_done(self) -> None:
        if self._assembly is not None and self._assembly.is_done:
            self._waiting = self._assembly.frame()
            self._seen_revision = max(self._seen_revision, self._waiting.revision)
            self._assembly = None

    def _acknowledge(self, frame: int) -> None:
        message = control_pb2.Control()
        message.frame_taken.number, message.frame_taken.frame = self.number, frame
        self._connection.post(message)


def set_size(view: Message, size: tuple[int, int]) -> None:
    """Of the whole picture, all of which is rendered."""
    width, height = size
    if not (1 <= width <= 65536 and 1 <= height <= 65536):
        raise InvalidInput("the size is not between 1x1 and 65536x65536")
    view.width, view.height = width, height
    view.window.x, view.window.y, view.window.width, view.window.height = 0, 0, width, height


def plain_view(size: tuple[int, int], *, channels: Sequence[str], renderer: str, bounces: int, seed: int,
               filter: str, layers: int, clamp: float | None = None, sky_sampling: str = "visible") -> Message:
    """A View message without a camera."""
    if clamp is not None and not 0.0 < clamp < math.inf:
        raise InvalidInput("clamp is not a number above 0: most that a path adds to a sample after its second bounce")
    if not 0 <= layers <= ALL_LAYERS:
        raise InvalidInput("the layers are not a mask of 32 bits: bit i is object layer i")
    if renderer not in RENDERERS:
        raise InvalidInput(f"there is no renderer '{renderer}': choose of {', '.join(RENDERERS)}")
    if sky_sampling not in ("visible", "luminance"):
        raise InvalidInput(f"there is no sky_sampling '{sky_sampling}': choose of visible, luminance")
    view = work_pb2.View(revision=1, seed=seed, max_bounces=bounces, filter_radius=0.5,
                         channels=channel_bits(list(channels)), renderer=RENDERERS.index(renderer),
                         filter=filter.encode(), hidden_layers=ALL_LAYERS & ~layers, clamp_indirect=clamp or 0.0)
    set_size(view, size)
    if sky_sampling == "visible":
        _sample_visible_sky(view)
    return view


def _sample_visible_sky(view: Message) -> None:
    # As the command line does: measuring takes a node as long as about half of these samples.
    view.sky_cells_from = -(-2**18 // (view.width * view.height))

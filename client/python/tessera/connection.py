"""Requests to the master and their replies, preserved when the connection is interrupted."""

from __future__ import annotations

import logging
import threading
import time
from dataclasses import dataclass
from typing import Any, Callable, Protocol

from . import bulk
from .blobs import BlobHeap, Fetch, answer
from .endpoint import Endpoint
from .errors import Error, InvalidInput, Malformed, Refused, Unavailable
from .keys import ClientKeys
from .link import Link, LinkSettings
from .proto import control_pb2
from .records import text
from .values import Blob

Message = Any
_LOG = logging.getLogger("tessera")
_MAX_BLOB = 4 << 30
_ANSWERS = {
    "adjust_display": "request_done", "close_scene": "request_done", "lock_objects": "request_done", "request_view": "request_done",
    "set_view_filter": "request_done",
    "read_scene": "scene_content", "read_members": "members", "read_history": "history", "read_writers": "writers",
    "pick": "picked", "read_trace": "trace",
}


class Watcher(Protocol):
    """A view: receives frames. Called while `changed` is held."""

    def reopened(self) -> Message: ...

    def began(self, header: bulk.FrameHeader, now: float) -> None: ...

    def awaits(self, part: bulk.PictureChunk | bulk.FrameTile) -> bool: ...

    def add(self, part: bulk.PictureChunk | bulk.FrameTile, now: float) -> None: ...

    def tick(self, now: float) -> None: ...

    def progressed(self, progress: Message) -> None: ...

    def ended(self, done: Message) -> None: ...


@dataclass
class _Call:
    """A request that the master has not answered yet."""

    expects: str
    build: Callable[[], Message]  # called again after every welcome
    blobs: BlobHeap | None = None  # served to the master during the call
    reply: Message = None
    error: Error | None = None


class Connection:
    """Receives messages on the link's thread; used by the session from any other thread. After an interruption it joins again
    with the same key, resends unanswered requests, reopens the views and, in a new session, acquires its locks again."""

    def __init__(self, where: Endpoint, keys: ClientKeys | None, settings: LinkSettings, key: int) -> None:
        self.changed = threading.Condition()  # protects everything below
        self.name, self._key = settings.name, key
        self.number = 0  # of the latest welcome
        self.joined: Message = None  # the latest SceneJoined
        self.joins = 0  # how often
        self.answered = 0  # sequence of the latest edit that has its answer
        self.locks: set[int] = set()
        self.views: dict[int, Watcher] = {}
        self._title, self._exclusive = "", False
        self._failure: Error | None = None
        self._rejoining = self._is_new = False
        self._calls: dict[object, _Call] = {}
        self._last_request = 0
        self._fetches: dict[bytes, Fetch] = {}
        self.link = Link(where, keys, settings, self)
        self.link.start()
        try:
            with self.changed:
                self.wait_until(lambda: self.number != 0, None)
        except BaseException:
            self.link.close()
            raise

    def close(self) -> None:
        with self.changed:
            self._failure = self._failure or InvalidInput("this session is closed")
            self.changed.notify_all()
        self.link.close()

    # ---- of the session ----

    def join(self, title: str, exclusive: bool, no_wait: bool, timeout: float | None) -> None:
        with self.changed:
            self._title, self._exclusive = title, exclusive
        self.ask("join", "scene_joined", lambda: self._join_request(no_wait), timeout)

    def leave_scene(self) -> None:
        """Called after the scene was closed."""
        with self.changed:
            self.joined, self.views, self.locks = None, {}, set()

    def require_joined(self) -> None:
        with self.changed:
            self._check()
            if self.joined is None:
                raise InvalidInput("no scene is joined: call session.join(title) first")

    def post(self, message: Message) -> None:
        """Sends a message that has no answer. It is dropped while the connection is down or the scene is joined again."""
        with self.changed:
            if not self._rejoining:
                self.link.send(message)

    def request(self, message: Message, timeout: float = 60.0) -> Message:
        """Sends a numbered request and returns the reply; raises Refused if the master rejects it."""
        self.require_joined()
        with self.changed:
            self._last_request += 1
            number = self._last_request
        kind = message.WhichOneof("message")
        getattr(message, kind).request = number
        expects = _ANSWERS[kind]
        reply = self.ask(number, expects, lambda: message, timeout)
        if reply.DESCRIPTOR.name == "RequestDone":
            if not reply.accepted:
                raise Refused(text(reply.text))
            if expects != "request_done":
                raise Malformed("the master confirmed a request without its answer")
        return reply

    def ask(self, key: object, expects: str, build: Callable[[], Message], timeout: float | None,
            blobs: BlobHeap | None = None) -> Message:
        """Raises Refused, Unavailable."""
        call = _Call(expects, build, blobs)
        with self.changed:
            self._check()
            self._calls[key] = call
            if not self._rejoining:
                self.link.send(build())
            try:
                self.wait_until(lambda: call.reply is not None or call.error is not None,
                                None if timeout is None else time.monotonic() + timeout)
            finally:
                self._calls.pop(key, None)
        if call.error is not None:
            raise call.error
        if call.reply is None:
            raise Unavailable("the master is connected but does not answer")
        return call.reply

    def fetch(self, blob: Blob) -> bytes:
        """Fetches a blob from the master. Raises Unavailable if it does not have it."""
        if blob.byte_size == 0:
            return b""
        if blob.byte_size > _MAX_BLOB:
            raise Refused(f"a blob of {blob.byte_size} bytes exceeds the limit of this package")
        with self.changed:
            fetch = self._fetches.setdefault(blob.hash, Fetch(blob))
            self._fetch_more(time.monotonic())
            try:
                self.wait_until(lambda: fetch.is_done or fetch.absent, None)
            finally:
                self._fetches.pop(blob.hash, None)
        if fetch.absent:
            raise Unavailable("the master does not have this blob any more: refresh the scene")
        return bytes(fetch.data)

    def wait_until(self, is_there: Callable[[], bool], deadline: float | None) -> None:
        """Call with `changed` held. Also returns at the deadline. Raises the error of a failed link."""
        while not is_there():
            self._check()
            rest = None if deadline is None else deadline - time.monotonic()
            if rest is not None and rest <= 0:
                return
            self.changed.wait(rest)

    def _check(self) -> None:
        if self._failure is not None:
            raise self._failure

    def _join_request(self, no_wait: bool) -> Message:
        request = control_pb2.Control()
        request.join_scene.title = self._title.encode("utf-8", "surrogateescape")
        request.join_scene.name = self.name.encode("utf-8", "surrogateescape")
        request.join_scene.key, request.join_scene.no_wait = self._key, no_wait
        request.join_scene.exclusive = self._exclusive
        return request

    # ---- of the link ----

    def welcomed(self, number: int, epoch: int) -> None:
        with self.changed:
            self._is_new = self._is_new or number != self.number
            self.number = number
            self.link.clear_queue()
            if self.joined is not None:
                self._rejoining = True
                self.link.send(self._join_request(False))
            else:
                self._resend()
            self.changed.notify_all()

    def control(self, message: Message) -> None:
        kind = message.WhichOneof("message")
        content = getattr(message, kind)
        with self.changed:
            if kind == "scene_joined":
                self._scene_joined(content)
            elif kind == "edit_reply":
                self._answer(("edit", content.sequence), kind, content)
            elif kind == "status_reply":
                self._answer("status", kind, content)
            elif kind == "refusal":
                self._refused(text(content.reason))
            elif kind == "view_progress":
                if content.number in self.views:
                    self.views[content.number].progressed(content.progress)
            elif kind == "view_done":
                if content.number in self.views:
                    self.views[content.number].ended(content)
            elif kind == "notice":
                _LOG.warning("%s", text(content.text))
            elif kind in _ANSWERS.values():
                self._answer(content.request, kind, content)
            self.changed.notify_all()

    def bulk_message(self, message: bulk.BulkMessage) -> None:
        now = time.monotonic()
        with self.changed:
            try:
                self._bulk(message, now)
            finally:
                self.changed.notify_all()

    def tick(self, now: float) -> None:
        with self.changed:
            self._fetch_more(now)
            for view in self.views.values():
                view.tick(now)

    def failed(self, error: Error) -> None:
        with self.changed:
            self._failure = self._failure or error
            self.changed.notify_all()

    def _bulk(self, message: bulk.BulkMessage, now: float) -> None:
        if isinstance(message, bulk.BlobRequest):
            heaps = [call.blobs.blobs for call in self._calls.values() if call.blobs is not None]
            data = next((heap[message.hash] for heap in heaps if message.hash in heap), None)
            self.link.send_bulk(answer(message, data))
        elif isinstance(message, bulk.BlobChunk):
            fetch = self._fetches.get(message.hash)
            if fetch is not None and not fetch.is_done:
                fetch.receive(message, now)
                self._fetch_more(now)
        elif isinstance(message, bulk.BlobAbsent):
            if message.hash in self._fetches:
                self._fetches[message.hash].absent = True
        elif isinstance(message, bulk.FrameHeader):
            if message.view in self.views:
                self.views[message.view].began(message, now)
        elif isinstance(message, (bulk.PictureChunk, bulk.FrameTile)):
            for view in self.views.values():
                if view.awaits(message):
                    view.add(message, now)
                    break

    def _fetch_more(self, now: float) -> None:
        for fetch in self._fetches.values():
            for request in fetch.due(now):
                self.link.send_bulk(request)

    def _scene_joined(self, joined: Message) -> None:
        if joined.queue_position:
            _LOG.info("the cluster is busy: waiting, queue position %d", joined.queue_position)
            return
        if joined.last_sequence < self.answered:
            self.failed(Unavailable("the master has lost edits that it had accepted (was it restarted without its session "
                                    "folder?): reconnect and check the scene"))
            return
        self.joined = joined
        self.joins += 1
        self._answer("join", "scene_joined", joined)
        if self._rejoining:
            self._rejoining = False
            if self._is_new and self.locks:
                self.link.send(lock_request(sorted(self.locks), release=False))
            for view in self.views.values():
                self.link.send(view.reopened())
            self._resend()
        self._is_new = False

    def _resend(self) -> None:
        for call in self._calls.values():
            if call.reply is None and call.error is None:
                self.link.send(call.build())

    def _answer(self, key: object, kind: str, content: Message) -> None:
        call = self._calls.get(key)
        if call is not None and kind in (call.expects, "request_done"):
            call.reply = content
        elif kind == "request_done" and not content.accepted:
            _LOG.warning("the master refuses: %s", text(content.text))

    def _refused(self, reason: str) -> None:
        """Refusals have no request number: they are matched to the oldest unanswered request."""
        error = Refused("the master refuses: " + reason)
        if self._rejoining:
            self.failed(error)
            return
        waiting = [call for call in self._calls.values() if call.reply is None and call.error is None]
        if waiting:
            waiting[0].error = error
        else:
            _LOG.warning("%s", error)


def lock_request(objects: list[int], release: bool) -> Message:
    request = control_pb2.Control()
    request.lock_objects.objects.extend(objects)
    request.lock_objects.release = release
    return request

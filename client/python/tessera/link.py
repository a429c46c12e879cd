"""The two sockets of a session and the thread that owns them: hello, heartbeats, reconnecting.

    greeting   hello sent            welcome -> joined, silence -> away, refusal -> over
    joined     all messages sent     silence, goodbye -> away, unknown -> greeting
    away       until the back-off ends, then new sockets -> greeting
    over       failed for good, or closed

Also over after `connect_limit` without a first welcome, later after `lost_limit` without any message. Messages sent
while not connected are dropped: the session sends them again after the next welcome.
"""

from __future__ import annotations

import os
import socket
import threading
import time
from collections import deque
from dataclasses import dataclass
from typing import Any, Protocol

import zmq

from . import bulk
from .endpoint import Endpoint
from .errors import Error, Malformed, Refused, Unavailable
from .keys import ClientKeys
from .parsing import parsed
from .proto import control_pb2

CONTROL_LIMIT = 64 * 1024
BULK_LIMIT = 1024 * 1024 + 4096
_QUEUE_BUDGET = 64 * 1024 * 1024
_CURVE_OVERHEAD = 33
_MAX_WAITING = 64  # bulk messages; the master requests dropped ones again
_BURST = 256  # so that a flood of messages does not delay heartbeats
_MIN_BACKOFF, _MAX_BACKOFF = 0.1, 5.0
_PROTOCOL, _CLIENT = 6, 0

Message = Any


class Listener(Protocol):
    """Callbacks of the link; called on the link's thread, never while it holds a lock."""

    def welcomed(self, number: int, epoch: int) -> None: ...

    def control(self, message: Message) -> None: ...

    def bulk_message(self, message: bulk.BulkMessage) -> None: ...

    def tick(self, now: float) -> None: ...

    def failed(self, error: Error) -> None: ...


@dataclass(frozen=True)
class LinkSettings:
    name: str
    software: str
    connect_limit: float
    lost_limit: float


class Link:
    """Sends from any thread; everything else runs on the link's thread."""

    def __init__(self, endpoint: Endpoint, keys: ClientKeys | None, settings: LinkSettings, listener: Listener) -> None:
        self._endpoint, self._keys, self._settings, self._listener = endpoint, keys, settings, listener
        self._context = zmq.Context()
        self._wake, self._alarm = socket.socketpair()
        self._wake.setblocking(False)
        self._alarm.setblocking(False)
        self._lock = threading.Lock()  # protects the next two members
        self._to_send: list[tuple[int, bytes]] = []
        self._closing = False
        # Used by the thread only:
        self._sockets: list[zmq.Socket[bytes]] = []
        self._outbox: tuple[deque[bytes], deque[bytes]] = (deque(), deque())
        self._state = "greeting"
        self._number = self._token = 0
        self._interval, self._missed = 1.0, 3
        self._last_heard = self._last_sent = self._last_greeting = time.monotonic()
        self._silent_since = self._last_heard  # not reset by new sockets
        self._return_at, self._backoff = 0.0, _MIN_BACKOFF
        self._master_sent_at = self._master_heard_at = 0
        self._goodbye = ""
        self.malformed = 0
        self._thread = threading.Thread(target=self._run, name="tessera-link", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def send(self, message: Message) -> None:
        """Any thread."""
        self._queue(0, message.SerializeToString())

    def send_bulk(self, message: bulk.BulkMessage) -> None:
        """Any thread."""
        self._queue(1, bulk.encode(message))

    def clear_queue(self) -> None:
        """Drops queued messages: after a new welcome, the session resends those that are still needed."""
        with self._lock:
            self._to_send.clear()

    def close(self) -> None:
        """Says goodbye and waits for the thread; flushes queued messages for at most a second. Idempotent."""
        with self._lock:
            self._closing = True
        self._wake_thread()
        if self._thread is not threading.current_thread():
            self._thread.join()

    def _queue(self, link: int, data: bytes) -> None:
        with self._lock:
            if self._closing:
                return
            self._to_send.append((link, data))
        self._wake_thread()

    def _wake_thread(self) -> None:
        try:
            self._alarm.send(b"!")
        except OSError:  # full: the thread will wake up anyway; closed: the thread has ended
            pass

    def _run(self) -> None:
        try:
            self._open()
            self._greet(time.monotonic())
            while self._step():
                pass
            if self._state == "joined":
                goodbye = control_pb2.Control()
                goodbye.goodbye.reason = b"done"
                self._push(goodbye)
                self._flush()
        except Error as error:
            self._listener.failed(error)
        except Exception as error:  # report every failure of the thread
            self._listener.failed(Error(f"the session's thread failed: {error!r}"))
        finally:
            with self._lock:
                self._closing = True
            self._close_sockets(1000)
            self._context.term()
            self._wake.close()
            self._alarm.close()

    def _step(self) -> bool:
        now = time.monotonic()
        wait = max(0.0, self._next_wake(now) - now)
        poller = zmq.Poller()
        for socket_ in self._sockets:
            poller.register(socket_, zmq.POLLIN)
        poller.register(self._wake, zmq.POLLIN)
        poller.poll(int(wait * 1000) + 1)
        try:
            self._wake.recv(4096)
        except BlockingIOError:
            pass
        for link, socket_ in enumerate(self._sockets):
            for _ in range(_BURST):
                try:
                    parts = socket_.recv_multipart(zmq.NOBLOCK)
                except zmq.Again:
                    break
                if len(parts) == 1:
                    self._receive(link, parts[0], time.monotonic())
                if self._state == "away":
                    break
        with self._lock:
            to_send, self._to_send = self._to_send, []
            closing = self._closing
        if self._state == "joined":
            for link, data in to_send:
                if link == 0 or len(self._outbox[1]) < _MAX_WAITING:
                    self._outbox[link].append(data)
        self._watch(time.monotonic())
        self._flush()
        return not closing

    def _receive(self, link: int, data: bytes, now: float) -> None:
        self._last_heard = self._silent_since = now
        self._backoff = _MIN_BACKOFF
        try:
            if link == 1:
                self._listener.bulk_message(bulk.decode(data))
                return
            self._control(parsed(control_pb2.Control, data), now)
        except Malformed:  # counts as lost; waiting calls have deadlines
            self.malformed += 1

    def _control(self, message: Message, now: float) -> None:
        kind = message.WhichOneof("message")
        if kind == "welcome":
            self._welcome(message.welcome, now)
        elif kind == "heartbeat":
            self._master_sent_at = message.heartbeat.sent_at
            self._master_heard_at = time.monotonic_ns()
        elif kind == "unknown":
            if now - self._last_greeting >= self._interval:
                self._greet(now)
        elif kind == "goodbye":
            self._goodbye = message.goodbye.reason.decode("utf-8", "replace")
            self._go_away(now)
        elif kind == "refusal" and self._state == "greeting":
            raise Refused("the master refuses: " + message.refusal.reason.decode("utf-8", "replace"))
        elif kind is not None:
            self._listener.control(message)

    def _welcome(self, welcome: Message, now: float) -> None:
        if welcome.peer_number == 0:
            raise Malformed("a welcome without a number")
        if self._state == "joined" and welcome.peer_number == self._number and welcome.token == self._token:
            return  # an answer to a hello said twice
        self._number, self._token = welcome.peer_number, welcome.token
        self._interval = min(60.0, max(0.01, welcome.heartbeat_interval * 1e-9))
        self._missed = max(1, welcome.missed_heartbeats)
        self._state = "joined"
        self._goodbye = ""
        self._beat(now)
        self._listener.welcomed(welcome.peer_number, welcome.epoch)

    def _greet(self, now: float) -> None:
        self._state = "greeting"
        self._last_greeting = now
        message = control_pb2.Control()
        hello = message.hello
        hello.protocol, hello.peer = _PROTOCOL, _CLIENT
        hello.name = self._settings.name.encode("utf-8", "surrogateescape")
        hello.host = socket.gethostname().encode()
        hello.software = self._settings.software.encode()
        hello.pid = os.getpid()
        hello.preferred_tile, hello.concurrent_units, hello.renderers = 32, 1, 3
        hello.resume_token = self._token
        self._push(message)

    def _beat(self, now: float) -> None:
        """The token on the bulk link goes with every heartbeat: harmless when known, and heals when it got lost."""
        message = control_pb2.Control()
        clock = time.monotonic_ns()
        message.heartbeat.sent_at = clock
        if self._master_sent_at:
            message.heartbeat.echo_sent_at = self._master_sent_at
            message.heartbeat.echo_delay = clock - self._master_heard_at
        message.heartbeat.version.SetInParent()
        self._push(message)
        self._outbox[1].appendleft(bulk.encode(bulk.BulkHello(self._token)))
        self._last_sent = now

    def _watch(self, now: float) -> None:
        never = self._number == 0
        if self._state != "joined" and now - self._silent_since >= (
                self._settings.connect_limit if never else self._settings.lost_limit):
            if never:
                raise Unavailable(f"no master answers at {self._endpoint.control}: is it running there, and is this "
                                  "key in its allow-list?")
            raise Unavailable(f"the master left: {self._goodbye}" if self._goodbye else
                              "the master does not respond any more: is it still running?")
        if self._state == "away":
            if now >= self._return_at:
                self._open()
                self._last_heard = now
                self._master_sent_at = 0
                self._greet(now)
            return
        if now - self._last_heard >= self._interval * self._missed:
            self._go_away(now)
        elif self._state == "joined" and now - self._last_sent >= self._interval:
            self._beat(now)
            self._listener.tick(now)

    def _go_away(self, now: float) -> None:
        for waiting in self._outbox:
            waiting.clear()  # belongs to the old sockets
        self._state = "away"
        self._return_at = now + self._backoff
        self._backoff = min(2 * self._backoff, _MAX_BACKOFF)

    def _next_wake(self, now: float) -> float:
        if any(self._outbox):
            return now + 0.002
        if self._state == "away":
            return self._return_at
        if self._state == "greeting":
            return now + self._interval / 4
        return min(self._last_sent + self._interval, self._last_heard + self._interval * self._missed)

    def _open(self) -> None:
        self._close_sockets(0)
        for address, limit in ((self._endpoint.control, CONTROL_LIMIT), (self._endpoint.bulk, BULK_LIMIT)):
            socket_: zmq.Socket[bytes] = self._context.socket(zmq.DEALER)
            self._sockets.append(socket_)
            for option, value in ((zmq.SNDHWM, _QUEUE_BUDGET // limit), (zmq.RCVHWM, _QUEUE_BUDGET // limit),
                                  (zmq.MAXMSGSIZE, limit + _CURVE_OVERHEAD), (zmq.HANDSHAKE_IVL, 5000),
                                  (zmq.TCP_KEEPALIVE, 1), (zmq.RECONNECT_IVL, 100), (zmq.RECONNECT_IVL_MAX, 5000),
                                  (zmq.LINGER, 0), (zmq.IPV6, int(self._endpoint.is_ipv6))):
                socket_.setsockopt(option, value)
            if self._keys is not None:
                socket_.setsockopt(zmq.CURVE_SERVERKEY, self._keys.master.encode())
                socket_.setsockopt(zmq.CURVE_PUBLICKEY, self._keys.public.encode())
                socket_.setsockopt(zmq.CURVE_SECRETKEY, self._keys.secret.encode())
            try:
                socket_.connect(address)
            except zmq.ZMQError as error:
                raise Unavailable(f"cannot connect to {address}: {error}") from None

    def _close_sockets(self, linger: int) -> None:
        for socket_ in self._sockets:
            socket_.close(linger)
        self._sockets = []

    def _push(self, message: Message) -> None:
        self._outbox[0].append(message.SerializeToString())

    def _flush(self) -> None:
        for socket_, waiting in zip(self._sockets, self._outbox):
            while waiting:
                try:
                    socket_.send(waiting[0], zmq.NOBLOCK)
                except zmq.Again:
                    break
                waiting.popleft()

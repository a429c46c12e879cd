"""A network line of limited rate in one process: forwards TCP connections between nodes and a master.

All connections of a direction share its rate, as on the cable to the master. CURVE passes through untouched. A line may fail:
hold() is a cable that is pulled for a while, forget() a firewall that drops its state, cut() closes connections.
"""

import collections
import contextlib
import queue
import random
import socket
import threading
import time

CHUNK = 32 << 10  # bytes that a connection puts on the line at once
# A line has small buffers, but the sockets of a relay have megabytes, in which film would wait that no real line holds.
SOCKET_BUFFER = 128 << 10  # bytes
BURST_SECONDS = 1e-3  # how far a sleep that lasts too long may be made up for
QUEUED_CHUNKS = 64  # of a connection, within the latency

Counts = collections.namedtuple("Counts", "at to_master to_nodes")  # s (monotonic), and bytes in each direction since the start


class Direction:
    """One direction of a line: `rate` in bits per second, `latency` and `jitter` in seconds."""

    def __init__(self, rate, latency, jitter):
        self.seconds_per_byte, self.latency, self.jitter = 8.0 / rate, latency, jitter
        self.byte_count = 0
        self._free_at = 0.0  # when the line has sent all that was given to it
        self._lock = threading.Lock()

    def occupy(self, size):
        """Occupies the line with `size` bytes. Returns when the last of them has been sent (s, monotonic)."""
        now = time.monotonic()
        with self._lock:
            begin = max(self._free_at, now - BURST_SECONDS)
            self._free_at = begin + size * self.seconds_per_byte
            self.byte_count += size
            return max(self._free_at, now)


def sleep_until(when):
    left = when - time.monotonic()
    if left > 0:
        time.sleep(left)


class Connection:
    """Both ends of a forwarded connection. Bytes pass while `passes` is set."""

    def __init__(self, near, far):
        self.near, self.far, self.passes = near, far, threading.Event()

    def cut(self):
        self.passes.set()
        for end in (self.near, self.far):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)


class Line:
    """Forwards 127.0.0.1:`port` + i to 127.0.0.1:`target` + i, for i of 0 to `ports` - 1. rate: bits per second in each direction;
    latency: seconds that each direction adds; jitter: up to so many more, at random. Use it in a with statement."""

    def __init__(self, port, target, *, ports=2, rate=1e9, latency=1e-4, jitter=0.0):
        self.rate = rate
        self.to_master, self.to_nodes = Direction(rate, latency, jitter), Direction(rate, latency, jitter)
        self._closed = False
        self._lock = threading.Lock()  # protects what follows
        self._sockets, self._threads, self._connections, self._forgotten, self._held = [], [], [], [], False
        try:
            for i in range(ports):
                self._start(self._accept, self._listener(port + i), ("127.0.0.1", target + i))
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def counts(self):
        """Bytes forwarded so far."""
        return Counts(time.monotonic(), self.to_master.byte_count, self.to_nodes.byte_count)

    def hold(self):
        """Nothing passes until go_on(), and no end notices: connections stay open, and new ones are accepted."""
        with self._lock:
            self._held = True
            for connection in self._connections:
                connection.passes.clear()

    def go_on(self):
        """Ends hold(): what was held passes on."""
        with self._lock:
            self._held = False
            for connection in self._connections:
                connection.passes.set()

    def forget(self):
        """The connections that there are stay open, but nothing passes over them any more. New ones work."""
        with self._lock:
            connections, self._connections = self._connections, []
            for connection in connections:
                connection.passes.clear()
            self._forgotten += connections

    def cut(self):
        """Closes all connections. New ones work."""
        with self._lock:
            connections, self._connections = self._connections, []
        for connection in connections:
            connection.cut()

    def close(self):
        """Closes all connections and waits for the threads. Idempotent."""
        self._closed = True
        self.cut()
        with self._lock:
            for connection in self._forgotten:
                connection.passes.set()
            sockets, threads = list(self._sockets), list(self._threads)
        for each in sockets:
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()
        for thread in threads:
            thread.join(5)

    def _start(self, function, *arguments):
        thread = threading.Thread(target=function, args=arguments, daemon=True)
        with self._lock:
            self._threads.append(thread)
        thread.start()

    def _keep(self, opened):
        with self._lock:
            self._sockets.append(opened)
        return opened

    def _listener(self, port):
        listener = self._keep(socket.socket())
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SOCKET_BUFFER)  # accepted sockets inherit it
        listener.bind(("127.0.0.1", port))
        listener.listen()
        return listener

    def _accept(self, listener, target):
        while not self._closed:
            try:
                near = self._keep(listener.accept()[0])
                far = self._keep(socket.socket())
            except OSError:  # closed
                return
            connection = Connection(near, far)
            with self._lock:  # before anyone can see that it is connected, and cut or forget it
                self._connections.append(connection)
                if not self._held:
                    connection.passes.set()
            try:
                far.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SOCKET_BUFFER)
                far.connect(target)
            except OSError:  # the master is not there: the node tries again
                near.close()
                with self._lock, contextlib.suppress(ValueError):
                    self._connections.remove(connection)
                continue
            for end in (near, far):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
            self._forward(near, far, connection.passes, self.to_master)
            self._forward(far, near, connection.passes, self.to_nodes)

    def _forward(self, source, sink, passes, direction):
        on_the_way = queue.Queue(QUEUED_CHUNKS)
        self._start(self._read, source, on_the_way, passes, direction)
        self._start(self._write, sink, on_the_way)

    @staticmethod
    def _received(source, passes):
        """The next bytes, b"" at the end; an end is held like all else."""
        try:
            data = source.recv(CHUNK)
        except OSError:
            data = b""
        passes.wait()
        return data

    def _read(self, source, on_the_way, passes, direction):
        while True:
            data = self._received(source, passes)
            sent_at = direction.occupy(len(data))
            # Bytes keep their order: the writer waits for each chunk before it looks at the next one.
            on_the_way.put((sent_at + direction.latency + random.uniform(0.0, direction.jitter), data))
            if not data:
                return
            sleep_until(sent_at)

    @staticmethod
    def _write(sink, on_the_way):
        broken = False
        while True:
            due, data = on_the_way.get()
            if not data:
                with contextlib.suppress(OSError):
                    sink.shutdown(socket.SHUT_WR)
                return
            if broken:  # takes what the reader still has, so that it never waits
                continue
            sleep_until(due)
            try:
                sink.sendall(data)
            except OSError:
                broken = True

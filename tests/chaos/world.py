"""A cluster of processes, each behind a line of its own, and what can befall them."""

import contextlib
import pathlib
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "process"), str(ROOT / "tests" / "python")]
from cluster import tail  # noqa: E402
from line import Line  # noqa: E402
from ports import free_port  # noqa: E402

START_SECONDS = 60  # that a master may take until it listens
LEAVE_SECONDS = 30  # that a process may take to end after SIGTERM


class ChaosError(Exception):
    """A promise was broken; the text says which one."""


class Process:
    """A program that is killed, stopped and started again. One that ends by itself is an error."""

    def __init__(self, start):
        self._start, self.child, self.is_stopped = start, None, False

    def start(self):
        if self.child is None:
            self.child = self._start()

    def end(self, number):
        """Sends the signal and waits for the end."""
        child, self.child = self.child, None
        if child is None:
            return
        child.send_signal(number)
        if self.is_stopped:
            child.send_signal(signal.SIGCONT)
            self.is_stopped = False
        try:
            status = child.wait(LEAVE_SECONDS)
        except subprocess.TimeoutExpired as error:
            raise ChaosError(f"{child.program} does not end within {LEAVE_SECONDS} s of signal {number}:\n{tail(child)}") from error
        if number == signal.SIGTERM and status != 0:
            raise ChaosError(f"{child.program} ends with status {status} after SIGTERM:\n{tail(child)}")

    def stop(self):
        if self.child is not None:
            self.child.send_signal(signal.SIGSTOP)
            self.is_stopped = True

    def go_on(self):
        if self.is_stopped:
            self.child.send_signal(signal.SIGCONT)
            self.is_stopped = False

    def check(self):
        if self.child is not None and self.child.poll() is not None:
            raise ChaosError(f"{self.child.program} ended by itself with status {self.child.returncode}:\n{tail(self.child)}")


class World:
    """Use it in a with statement."""

    def __init__(self, programs, links, backend):
        """links: by the name of a peer; those that begin with "node" are nodes."""
        self.programs, self._backend, self._links = programs, backend, links
        self.folder = programs.scratch / f"chaos-{time.monotonic_ns()}"
        self.folder.mkdir()
        self.keys = self.folder / "keys"
        programs.run("keys", self.keys)
        self.port = free_port()
        self._stack = contextlib.ExitStack()
        self.master = Process(self._start_master)
        self.nodes, self.lines, self._ports, self._joined = {}, {}, {}, 0

    def __enter__(self):
        try:
            self.master.start()
            for name in self._links:
                self._lay_line(name)
                if name.startswith("node"):
                    self.add_node(name, self._ports[name])
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in (*self.nodes.values(), self.master):
            process.go_on()
        self.programs.stop([process.child for process in (self.master, *self.nodes.values()) if process.child is not None])
        self._stack.close()

    def endpoint(self, peer=None):
        """Of the master; of the line of a peer to it."""
        return f"tcp://127.0.0.1:{self._ports[peer] if peer else self.port}"

    def run(self, *words):
        return self.programs.run(*words, "--master", self.endpoint(), "--keys", self.keys)[0]

    def add_node(self, name, port=None):
        def start():
            return self.programs.start("tessera-node", "--master", f"tcp://127.0.0.1:{port or self.port}", "--keys", self.keys, "--name",
                                       name, "--threads", "1", "--backend", self._backend)

        self.nodes[name] = Process(start)
        self.nodes[name].start()

    def begin(self, fault):
        """Returns what ends the fault, or None."""
        if fault.what == "join":
            return self._join()
        if fault.what in ("hold", "forget", "cut"):
            line = self.lines[fault.target]
            getattr(line, fault.what)()
            return line.go_on if fault.what == "hold" else None
        process = self.master if fault.target == "master" else self.nodes[fault.target]
        if fault.what == "stop":
            process.stop()
            return process.go_on
        process.end(signal.SIGKILL if fault.what == "kill" else signal.SIGTERM)
        return process.start

    def _join(self):
        self._joined += 1
        name = f"guest-{self._joined}"
        self.add_node(name)

        def leave():
            self.nodes.pop(name).end(signal.SIGTERM)

        return leave

    def check(self):
        for process in (self.master, *self.nodes.values()):
            process.check()

    def calm(self):
        """Ends all faults: what is stopped goes on, what was killed is started, links work."""
        self.master.go_on()
        self.master.start()
        for name, line in self.lines.items():
            line.go_on()
            if name in self.nodes:
                self.nodes[name].go_on()
                self.nodes[name].start()

    def _lay_line(self, name):
        link, port = self._links[name], free_port()
        self._ports[name] = port
        self.lines[name] = self._stack.enter_context(
            Line(port, self.port, rate=link.rate, latency=link.latency, jitter=link.jitter))

    def _start_master(self):
        master = self.programs.start("tessera-master", "--listen", self.endpoint(), "--keys", self.keys, "--heartbeat", "0.25",
                                     "--session", self.folder / "session", "--checkpoint", "2",
                                     "--max-crashes", "1000")  # kills are no crashes over samples, but look like them
        until = time.monotonic() + START_SECONDS
        while "listening on" not in master.log.read_text(errors="replace"):
            if master.poll() is not None or time.monotonic() > until:
                raise ChaosError(f"the master does not start:\n{tail(master)}")
            time.sleep(0.01)
        return master

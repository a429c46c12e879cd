"""Master and nodes as processes with CURVE keys of their own, and the programs that a test or benchmark runs with them."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))
from ports import free_port  # noqa: E402

START_SECONDS = 60  # that a master or node may take until it answers
STOP_SECONDS = 5  # until a process that was asked to end is killed
TICKS = os.sysconf("SC_CLK_TCK")


class ClusterError(Exception):
    """A program cannot be run, or has failed; the text says why and what helps."""


def cpu_seconds(pid):
    """User and system time of a running process and all of its threads, in s."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def tail(child, lines=8):
    """The end of the log of a process, for an error."""
    return "\n".join("    " + line for line in child.log.read_text(errors="replace").strip().split("\n")[-lines:])


def load_package(folder):
    """The package `tessera` of a build."""
    sys.path.insert(0, str(folder))
    try:
        import tessera
    except ImportError as error:
        raise ClusterError(f"the Python package 'tessera' cannot be used ({error}): build it (deploy/setup.sh), name its folder, as "
                           "build/release/python, and run this script with /usr/bin/python3, which has python3-zmq and python3-protobuf") from error
    return tessera


class Programs:
    """The programs of one build, and everything that was started from it; ends all of it at the end of the with statement."""

    NEEDED = ("tessera", "tessera-master", "tessera-node")

    def __init__(self, folder):
        self.folder = pathlib.Path(folder).resolve()
        missing = [name for name in self.NEEDED if not os.access(self.folder / name, os.X_OK)]
        if missing:
            raise ClusterError(f"no {', '.join(missing)} in {self.folder}: build with deploy/setup.sh, or name the folder with --bin")
        self._temporary = tempfile.TemporaryDirectory(prefix="tessera-wire-")
        self.scratch = pathlib.Path(self._temporary.name)
        self._children, self._logs = [], 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second Ctrl-C would leave some behind
        self.stop(self._children)
        self._temporary.cleanup()
        signal.signal(signal.SIGINT, before)

    def start(self, program, *options, out=None):
        """A process in a session of its own, so that Ctrl-C reaches this script alone, which then ends the others in order."""
        self._logs += 1
        log = self.scratch / f"{self._logs}-{program}.log"
        with open(log, "w", encoding="utf-8") as errors:
            child = subprocess.Popen([self.folder / program, *map(str, options)], stdin=subprocess.DEVNULL, stdout=out or errors,
                                     stderr=errors, text=True, start_new_session=True)
        child.program, child.log = program, log
        self._children.append(child)
        return child

    def stop(self, children):
        """Ends processes of start(), the latest first."""
        children = list(children)
        for child in reversed(children):
            if child.poll() is None:
                child.send_signal(signal.SIGTERM)
        for child in reversed(children):
            try:
                child.wait(STOP_SECONDS)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        self._children = [child for child in self._children if child not in children]

    def run(self, *words):
        """Runs `tessera` with these words. Returns its output and its processor time in s."""
        child = self.start("tessera", *words, out=subprocess.PIPE)
        with child.stdout:
            out = child.stdout.read()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        self._children.remove(child)
        if child.returncode != 0:
            raise ClusterError(f"tessera {words[0]} failed with status {child.returncode}:\n{tail(child)}")
        return out, usage.ru_utime + usage.ru_stime

    def version(self):
        return self.run("--version")[0].strip()


class Cluster:
    """A master and nodes with one worker each. Use it in a with statement."""

    def __init__(self, programs, nodes, *, backend="embree", line=None, master_options=()):
        """line: a function of two ports that connects the first with the second one, and returns a context manager; nodes then
        connect to the first one. None: they connect directly."""
        self.programs, self._children, self._line = programs, [], None
        self._master_options, self.master = master_options, None
        try:
            self.keys = programs.scratch / "keys"
            if not self.keys.exists():
                programs.run("keys", self.keys)
            self.port = self._start_master()
            port = self.port
            if line:
                port = free_port()
                self._line = line(port, self.port)
            for i in range(nodes):
                self.start_node(f"node-{i + 1}", "--backend", backend, port=port)
            self.wait_for(nodes)
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def children(self):
        """The processes of the master and of the nodes."""
        return list(self._children)

    @property
    def line(self):
        return self._line

    @property
    def endpoint(self):
        return f"tcp://127.0.0.1:{self.port}"

    def start_node(self, name, *options, port=None):
        """port: of a line to the master; None: of the master."""
        node = self.programs.start("tessera-node", "--master", f"tcp://127.0.0.1:{port or self.port}", "--keys", self.keys, "--name",
                                   name, "--threads", "1", *options)
        self._children.append(node)
        return node

    def close(self):
        self.programs.stop(self._children)
        if self._line:
            self._line.close()

    def run(self, command, *words):
        """A command of `tessera` that takes a cluster: its output and its processor time in s."""
        return self.programs.run(command, *words, "--master", self.endpoint, "--keys", self.keys)

    def status(self):
        return json.loads(self.run("status", "--json")[0])

    def cpu_seconds(self):
        """Of master and nodes since their start. Raises ClusterError if one of them has ended."""
        self.check()
        return sum(cpu_seconds(child.pid) for child in self._children)

    def check(self):
        for child in self._children:
            if child.poll() is not None:
                raise ClusterError(f"{child.program} ended with status {child.returncode}:\n{tail(child)}")

    def _start_master(self):
        """Another process may take a port between its choice and its use, so a master that ends is started at another one."""
        for _ in range(5):
            port = free_port()
            master = self.programs.start("tessera-master", "--listen", f"tcp://127.0.0.1:{port}", "--keys", self.keys,
                                         *self._master_options)
            until = time.monotonic() + START_SECONDS
            while master.poll() is None and time.monotonic() < until:
                if "listening on" in master.log.read_text(errors="replace"):
                    self._children.append(master)
                    self.master = master
                    return port
                time.sleep(0.02)
            self.programs.stop([master])
        raise ClusterError(f"the master does not start:\n{tail(master)}")

    def wait_for(self, nodes):
        """Until so many nodes have joined."""
        until = time.monotonic() + START_SECONDS
        while time.monotonic() < until:
            self.check()
            if len(self.status()["nodes"]) == nodes:
                return
            time.sleep(0.1)
        raise ClusterError(f"{nodes} nodes did not join within {START_SECONDS} s:\n{tail(self._children[-1])}")

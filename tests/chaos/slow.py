#!/usr/bin/env python3
"""A slow master, a slow node, clients that do not read: for a minute each, while film and frames come as fast as nodes make them.

A slow process is stopped nine tenths of the time. Sampled is the resident memory of every process. The master may not take more than
its limit (--memory) and what it takes without work; and no process may grow: its median of the last quarter of the time may exceed
that of the second one by 5 % or 16 MiB.

    slow.py BIN_FOLDER PYTHON_FOLDER --seconds 60

Exit status: 0 all are bounded, 1 one is not, or a process has ended, 64 wrong use.
"""

import contextlib
import signal
import statistics
import threading
import time

from command import end_with, new_parser, package
from soak import resident_bytes
from work import SCENE, Editor
from world import ChaosError

from cluster import Cluster, ClusterError, Programs

PERIOD, RUNS = 0.5, 0.05  # s: how often a slow process runs, and for how long
MEMORY = 256  # MiB: of the master
GROWTH, SLACK = 1.05, 16 << 20
SIZE, SPP = "960x540", "100000"  # more than a minute takes


class Slowed:
    """Stops a process nine tenths of the time. Use it in a with statement."""

    def __init__(self, child):
        self._child, self._end = child, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self._thread.join()

    def _run(self):
        while not self._end.is_set():
            self._child.send_signal(signal.SIGSTOP)
            self._end.wait(PERIOD - RUNS)
            self._child.send_signal(signal.SIGCONT)
            self._end.wait(RUNS)


class Memory:
    """Resident bytes of processes over time."""

    def __init__(self, processes):
        """processes: by name."""
        self._processes, self.samples = processes, {name: [] for name in processes}

    def watch(self, seconds):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            for name, child in self._processes.items():
                if child.poll() is not None:
                    raise ChaosError(f"{name} has ended with status {child.returncode}")
                self.samples[name].append(resident_bytes(child.pid))
            time.sleep(0.2)

    def check(self, limits):
        """limits: the most bytes that a process may take, by name."""
        for name, taken in self.samples.items():
            quarter = len(taken) // 4
            early, late = statistics.median(taken[quarter:2 * quarter]), statistics.median(taken[-quarter:])
            print(f"  {name:8} {early / 2**20:7.1f} MiB, later {late / 2**20:7.1f}, at most {max(taken) / 2**20:7.1f}", flush=True)
            if late > max(early * GROWTH, early + SLACK):
                raise ChaosError(f"{name} grows from {early} to {late} bytes")
            if max(taken) > limits.get(name, max(taken)):
                raise ChaosError(f"{name} takes {max(taken)} bytes, more than {limits[name]}")


class Stage:
    """A master with a memory limit, and two nodes. Use it in a with statement."""

    def __init__(self, programs):
        self._programs, self._stack = programs, contextlib.ExitStack()

    def __enter__(self):
        self.cluster = self._stack.enter_context(Cluster(self._programs, 2, backend="null", master_options=["--memory", MEMORY]))
        self.master, *nodes = self.cluster.children
        self.processes = {"master": self.master, **{f"node-{i + 1}": node for i, node in enumerate(nodes)}}
        self.limits = {"master": resident_bytes(self.master.pid) + (MEMORY << 20)}
        return self

    def __exit__(self, *problem):
        return self._stack.__exit__(*problem)

    def endpoint(self, _):
        """Of the master, for any peer."""
        return self.cluster.endpoint

    @property
    def keys(self):
        return self.cluster.keys

    def start_render(self):
        return self._start("render", SCENE, "--size", SIZE, "--spp", SPP, "-o", self._programs.scratch / "slow.exr")

    def start_watch(self):
        # As sampled: what a denoiser keeps grows until each size of picture has been made twice.
        return self._start("watch", "--size", SIZE, "--spp", "16", "--denoise=none", "-o", self._programs.scratch / "slow.png")

    def _start(self, command, *words):
        child = self._programs.start("tessera", command, *words, "--master", self.cluster.endpoint, "--keys", self.cluster.keys)
        self._stack.callback(self._programs.stop, [child])
        return child

    def wait_for_work(self):
        until = time.monotonic() + 60
        while not any(node["units_in_flight"] > 0 for node in self.cluster.status()["nodes"]):
            if time.monotonic() > until:
                raise ChaosError("no node gets any work")
            time.sleep(0.2)

    def measure(self, seconds, **more):
        """more: further processes to watch, by name."""
        memory = Memory({**self.processes, **more})
        memory.watch(seconds)
        memory.check(self.limits)


def slow_master(programs, _, seconds):
    with Stage(programs) as stage:
        render = stage.start_render()
        stage.wait_for_work()
        with Slowed(stage.master):
            stage.measure(seconds, client=render)


def slow_node(programs, _, seconds):
    with Stage(programs) as stage:
        render = stage.start_render()
        stage.wait_for_work()
        with Slowed(stage.processes["node-1"]):
            stage.measure(seconds, client=render)


def silent_client(programs, tessera, seconds):
    """One client is stopped as it watches; another one edits, and never asks for a frame of the view that it has opened."""
    with Stage(programs) as stage, Editor(tessera, stage) as editor:
        with tessera.connect(stage.endpoint("bob"), keys=stage.keys, name="bob") as bob:
            bob.join("chaos")
            with bob.transaction() as edit:
                edit.create("camera", name="eye")
        stopped = stage.start_watch()
        stage.wait_for_work()
        stopped.send_signal(signal.SIGSTOP)
        try:
            stage.measure(seconds, stopped=stopped, idle=Myself())
        finally:
            stopped.send_signal(signal.SIGCONT)
        editor.finish()
        if editor.edits < seconds:
            raise ChaosError(f"only {editor.edits} edits in {seconds:g} s")


class Myself:
    """This process, which has the client that never asks for a frame."""

    pid = "self"

    def poll(self):
        return None


CASES = {"slow-master": slow_master, "slow-node": slow_node, "silent-client": silent_client}


def main():
    parser = new_parser(__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long each (60)")
    parser.add_argument("--only", choices=list(CASES), help="one of them")
    options = parser.parse_args()
    tessera = package(options)
    failed = 0
    for name, case in CASES.items():
        if options.only not in (None, name):
            continue
        print(f"{name}:", flush=True)
        try:
            with Programs(options.programs) as programs:
                case(programs, tessera, options.seconds)
        except (ChaosError, ClusterError, tessera.Error) as error:
            failed += 1
            print(f"  {type(error).__name__}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    end_with(main)

#!/usr/bin/env python3
"""Real processes under faults that a seed decides: kills, stops, cut and silent links, restarts of the master.

Each schedule runs a master with a session folder and three nodes, each behind a line of its own, with CURVE. First a client renders
one picture after the other, and a job renders without a client; then another client edits a live scene that it watches. Afterwards:
    every picture has the bits of one process, and so has the job
    every acknowledged edit is in the scene
    no process has ended that was not killed; no node is in quarantine; the master has caught no exception
    units: issued + reissued = merged + duplicate + cancelled + refused + lost
    a node that joins late renders the edited scene with the same bits as those that lived through the edits

    chaos.py BIN_FOLDER PYTHON_FOLDER --seeds 1-10
    chaos.py BIN_FOLDER PYTHON_FOLDER --seeds 7 --verbose    # one again; the faults come at the same times

Exit status: 0 all held, 1 one of them did not, 64 wrong use.
"""

import heapq
import json
import pathlib
import shutil
import signal
import sys
import time

from command import end_with, new_parser, package, wrong_use
from faults import draw_faults, draw_links
from work import Editor, Expected, Job, Renders, wait_until
from world import ChaosError, World

from cluster import ClusterError, Programs

NODES = ["node-1", "node-2", "node-3"]
PATIENCE = 120  # s until a calm cluster has finished everything
CHECKED = dict(size=(64, 48), spp=64, picture="none", film=True, channels=("radiance", "normal", "depth"), seed=3)


class Run:
    """One schedule: first pictures, then a live scene, since a cluster has one scene at a time."""

    def __init__(self, seed, seconds, world, tessera, expected, say):
        self.seed, self.seconds, self.world, self.tessera, self.say = seed, seconds, world, tessera, say
        self.renders, self.editor = Renders(world, expected), None
        self.job = Job(world, expected)
        self.fault_count = 0

    def go(self):
        self.renders.start()
        self._let_it_happen("render")
        self.renders.stop(signal.SIGCONT)
        self._wait(lambda: not self.renders.step(False), "the render ends")
        self._wait(self.job.has_ended, "the job ends")
        self.job.check()
        with Editor(self.tessera, self.world) as self.editor:
            self._let_it_happen("editor")
            self.editor.finish()
            self.say("the edits are acknowledged")
            with self.tessera.connect(self.world.endpoint(), keys=self.world.keys, name="bob") as session:
                self.editor.check(session)
                self.editor.session.close()
                self._check_late_node(session)
                self.say("the late node has the same bits")
                session.close_scene()
        self._check_status()

    def _wait(self, done, what):
        wait_until(lambda: self.world.check() or done(), PATIENCE, f"not yet: {what}")
        self.say(what)

    # ---- faults ----

    def _let_it_happen(self, client):
        faults = draw_faults(self.seed, self.seconds, NODES, client)
        self.fault_count += len(faults)
        begin, events = time.monotonic(), [(fault.at, number, fault) for number, fault in enumerate(faults)]
        while events or time.monotonic() < begin + self.seconds:
            self.world.check()
            if client == "render":
                self.renders.step(True)
            now = time.monotonic() - begin
            if events and events[0][0] <= now:
                _, number, what = heapq.heappop(events)
                if callable(what):
                    what()
                    continue
                self.say(str(what))
                end = self._begin(what)
                if end is not None:
                    heapq.heappush(events, (what.at + what.seconds, number, end))
                continue
            time.sleep(0.01)
        self.world.calm()

    def _begin(self, fault):
        """Returns what ends it, or None."""
        if fault.target != "render" or fault.what not in ("kill", "stop"):
            return self.world.begin(fault)
        if fault.what == "kill":
            return self.renders.kill()
        self.renders.stop(signal.SIGSTOP)
        return lambda: self.renders.stop(signal.SIGCONT)

    # ---- promises ----

    def _film(self, session):
        rendered = session.render(self.editor.pose, wait=PATIENCE, **CHECKED)
        if rendered.summary.outcome != "complete":
            raise ChaosError(f"the edited scene was not rendered: {rendered.summary.outcome}, {rendered.summary.message}")
        film = rendered.frame.film()
        return rendered.summary.nodes, film.counts, [film.planes(name) for name in CHECKED["channels"]]

    def _check_late_node(self, session):
        survivors, *film = self._film(session)
        for process in self.world.nodes.values():
            process.end(signal.SIGTERM)
        self.world.add_node("late")
        late, *again = self._film(session)
        if set(late) != {"late"} or "late" in survivors:
            raise ChaosError(f"rendered by {survivors} and then by {late}")
        if film != again:
            raise ChaosError("a node that joined late renders other bits than those that lived through the edits")

    def _check_status(self):
        self.world.check()
        status = json.loads(self.world.run("status", "--json"))
        if status["caught_exceptions"]:
            raise ChaosError(f"the master has caught {status['caught_exceptions']} exceptions")
        units = status["units"]
        if units["issued"] + units["reissued"] != sum(units[end] for end in ("merged", "duplicate", "cancelled", "refused", "lost")):
            raise ChaosError(f"units are unaccounted for: {units}")
        if status["contradictions"]:
            raise ChaosError("nodes contradict each other")
        logs = "".join(path.read_text(errors="replace") for path in self.world.programs.scratch.glob("*-tessera-master.log"))
        if "quarantine" in logs:
            raise ChaosError("an honest node was put into quarantine: " + next(line for line in logs.split("\n") if "quarantine" in line))


def seeds_of(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def run(seed, options, tessera, expected, programs):
    links = draw_links(seed, [*NODES, "render", "editor"])
    began = time.monotonic()
    with World(programs, links, options.backend) as world:
        schedule = Run(seed, options.seconds, world, tessera, expected,
                       (lambda text: print(f"{time.monotonic() - began:6.2f} s  {text}", flush=True)) if options.verbose else lambda text: None)
        try:
            schedule.go()
        finally:
            if schedule.renders.process is not None:
                schedule.renders.process.kill()
    print(f"seed {seed}: {schedule.fault_count} faults, {schedule.renders.finished} pictures, {schedule.renders.killed} killed clients, "
          f"{schedule.editor.edits} edits, {time.monotonic() - began:.1f} s", flush=True)


def main():
    parser = new_parser(__doc__)
    parser.add_argument("--seeds", type=seeds_of, default=range(1, 11), help="one seed, or the first and the last: 1-10")
    parser.add_argument("--seconds", type=float, default=5.0, help="how long faults go on, twice (5)")
    parser.add_argument("--backend", default="embree", help="back-end of the nodes (embree)")
    parser.add_argument("--keep", type=pathlib.Path, help="keep the logs of a failed schedule in this folder")
    parser.add_argument("--verbose", action="store_true", help="print the faults")
    options = parser.parse_args()
    failed = []
    tessera = package(options)
    try:
        with Programs(options.programs) as programs:
            expected = Expected(programs, options.backend)
    except ClusterError as error:
        wrong_use(str(error))
    for seed in options.seeds:
        with Programs(options.programs) as programs:
            try:
                run(seed, options, tessera, expected, programs)
            except (ChaosError, ClusterError, tessera.Error) as error:
                failed.append(seed)
                print(f"seed {seed}: {type(error).__name__}: {error}\n"
                      f"  again: {sys.argv[0]} {options.programs} {options.python} --seeds {seed} --seconds {options.seconds:g} --verbose",
                      flush=True)
                if options.keep:
                    shutil.copytree(programs.scratch, options.keep / f"seed-{seed}", dirs_exist_ok=True,
                                    ignore=shutil.ignore_patterns("*.sock"))
    print(f"{len(options.seeds)} schedules, {len(failed)} failed" + (f": {failed}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    end_with(main)

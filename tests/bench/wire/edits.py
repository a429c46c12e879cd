"""Edits of a live scene while its film fills the line between nodes and master."""

import json
import math
import sys
import threading
import time

from cluster import Cluster, ClusterError, load_package
from line import Line

EDITOR = "editor"
CHANNELS = ("radiance", "low_variance", "high_variance", "albedo", "normal", "depth")  # those of an EXR
OBJECT_OFFSET = 0.01  # m, that an edit moves an object to and fro
WARM_UP_SECONDS = 2.0  # of rendering before the first edit: queues on the line are full then
PATIENCE = 30.0  # s until the last edits have a picture
TRACED_EDITS = 4096  # that a master keeps
ENOUGH_SAMPLES = 1 << 20  # per pixel: the view is never complete


def percentile(values, part):
    """Nearest rank: the smallest value that at least `part` of all do not exceed."""
    return sorted(values)[max(0, math.ceil(part * len(values)) - 1)]


def durations(trace, editor):
    """Seconds from each edit of this client to the first merged picture that shows it, from `tessera status --chrome-trace`: "to
    master" begins when the client submits, "to picture" ends when the picture is merged. None: without a picture."""
    begins, ends = {}, {}
    for event in trace["traceEvents"]:
        name, at = event["name"], event.get("ts")
        if event["ph"] == "b" and name.endswith(" to master") and event["args"]["by"] == editor:
            begins[event["id"]] = at
        elif event["ph"] == "e" and name.endswith(" to picture"):
            ends[event["id"]] = at
    return [(ends[edit] - begin) * 1e-6 if edit in ends else None for edit, begin in begins.items()]


class Watcher(threading.Thread):
    """Takes the pictures of a view, as a display would, in a with statement."""

    def __init__(self, view, session_error):
        super().__init__(daemon=True)
        self.view, self.pictures, self.newest = view, 0, (0, 0)
        self._session_error, self._end = session_error, threading.Event()

    def run(self):
        while not self._end.is_set():
            try:
                frame = self.view.next_frame(0.1)
            except self._session_error:  # the next edit fails, too, and reports it
                return
            if frame is not None:
                self.pictures += 1
                self.newest = max(self.newest, frame.version)

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self.join()

    def wait_for(self, version, cluster):
        until = time.monotonic() + PATIENCE
        while self.newest < version:
            cluster.check()
            if not self.is_alive() or time.monotonic() > until:
                raise ClusterError(f"no picture of the latest edit after {PATIENCE:g} s")
            time.sleep(0.01)


class Edits:
    """Small edits in turn: the colour of a material, and the place of an object."""

    def __init__(self, tessera, session, scene):
        self._translation, self._multiply, self._session = tessera.translation, tessera.multiply, session
        visible = {geometry.id for geometry in scene.all(tessera.Geometry)}
        self._materials = list(scene.all(tessera.Material))
        self._transforms = [each for each in scene.all(tessera.Transform) if visible.intersection(each.children)]
        if not self._materials and not self._transforms:
            raise ClusterError("the scene has no materials and no transforms to edit: choose another one with --scene")

    def submit(self, i):
        with self._session.transaction() as edit:
            chosen = (self._materials, self._transforms)[i % 2] or self._materials or self._transforms
            target = chosen[i // 2 % len(chosen)]
            if chosen is self._materials:
                edit.set(target, base_color=(*(0.5 + 0.4 * math.sin(0.7 * i + shift) for shift in (0.0, 2.1, 4.2)), 1.0))
            else:
                offset = self._translation(OBJECT_OFFSET * math.sin(i), 0.0, 0.0)
                edit.set(target, matrix=self._multiply(offset, target.matrix))


def wait_for_clock(session):
    """The master learns the offset of a client's clock from heartbeats; before, its edits have no beginning."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        if any(member.name == EDITOR and member.clock_bound_seconds > 0 for member in session.members().members):
            return
        time.sleep(0.1)
    raise ClusterError(f"the master did not measure the clock of the editing client within {PATIENCE:g} s")


def quoted(path):
    """As a word of an edit script."""
    return '"' + str(path).replace("\\", "\\\\").replace('"', '\\"') + '"'


def edit_for(options, edits, cluster, progress):
    """Returns the number of edits. Their times vary by half an interval, so that they meet all phases of a picture."""
    begin, interval = time.monotonic(), 1.0 / options.edit_rate
    total = max(1, round(options.seconds * options.edit_rate))
    for i in range(total):
        due = begin + interval * (i + 0.5 * (i * 37 % 60) / 60)
        time.sleep(max(0.0, due - time.monotonic()))
        edits.submit(i)
        cluster.check()
        progress(f"edit {i + 1} of {total}")
    time.sleep(max(0.0, begin + interval * total - time.monotonic()))
    return total


def edit_and_watch(tessera, cluster, options, progress):
    """Returns rates while the scene is edited, by name, in the unit that the name ends with."""
    with tessera.connect(cluster.endpoint, keys=cluster.keys, name=EDITOR) as session:
        scene = session.join("bench")
        edits = Edits(tessera, session, scene)
        wait_for_clock(session)
        view = session.open_view(scene.all(tessera.Camera)[0], size=options.size, spp=ENOUGH_SAMPLES, picture="jpeg",
                                 channels=CHANNELS)
        with Watcher(view, tessera.Error) as watcher:
            watcher.wait_for(session.refresh().version, cluster)
            time.sleep(WARM_UP_SECONDS)
            line, cpu, pictures = cluster.line.counts(), cluster.cpu_seconds(), watcher.pictures
            count = edit_for(options, edits, cluster, progress)
            end, cpu, pictures = cluster.line.counts(), cluster.cpu_seconds() - cpu, watcher.pictures - pictures
            watcher.wait_for(session.refresh().version, cluster)
    seconds = end.at - line.at
    to_master = (end.to_master - line.to_master) / seconds
    return {
        "edits": count, "seconds": seconds, "pictures_per_second": pictures / seconds, "cpu_cores": cpu / seconds,
        "to_master_bytes_per_second": to_master, "to_nodes_bytes_per_second": (end.to_nodes - line.to_nodes) / seconds,
        "busy": 8.0 * to_master / options.rate,
    }


def measure(programs, options, backend, progress):
    """Edits at options.edit_rate a second for options.seconds, of a scene that two nodes with this back-end render over a line of
    options.rate bits per second. Returns figures by name, in the unit that the name ends with."""
    tessera = load_package(options.python)

    def line(port, target):
        return Line(port, target, rate=options.rate, latency=options.latency)

    path = programs.scratch / "trace.json"
    with Cluster(programs, 2, backend=backend, line=line) as cluster:
        cluster.run("edit", "--name", "loader", "--scene", "bench", "-c", f"load {quoted(options.scene)}")
        try:
            figures = edit_and_watch(tessera, cluster, options, progress)
        except tessera.Error as error:
            cluster.check()  # the reason, if a process has ended
            raise ClusterError(f"the session with the master failed: {error}") from error
        stages = json.loads(cluster.run("status", "--json", "--chrome-trace", path)[0])["live"]["stages"]
    found = durations(json.loads(path.read_text()), EDITOR)
    shown = [each for each in found if each is not None]
    if not len(shown) == len(found) == min(figures["edits"], TRACED_EDITS):
        raise ClusterError(f"of {figures['edits']} edits {len(found)} are in the master's trace, {len(shown)} of them with a picture")
    parts = {"p50_seconds": 0.50, "p95_seconds": 0.95, "p99_seconds": 0.99, "longest_seconds": 1.0}
    return {"backend": backend, **figures, **{name: percentile(shown, part) for name, part in parts.items()}, "stages": stages}

"""What users do with the cluster meanwhile: they render pictures and edit a scene."""

import json
import subprocess
import sys
import threading
import time

from world import ROOT, ChaosError, tail

sys.path.insert(0, str(ROOT / "tests" / "process"))
from same_film import pixels_of  # noqa: E402

SCENE = ROOT / "tests" / "scenes" / "room-1.glb"
FRAMES = [["--size", "96x64", "--spp", "64", "--policy", "mixed"], ["--size", "130x70", "--spp", "24", "--policy", "tiled"],
          ["--size", "64x64", "--spp", "75", "--policy", "cooperative"], ["--size", "96x64", "--noise", "0.2"]]
JOB = ["--size", "100x60", "--noise", "0.14", "--seed", "9", "--exposure", "0"]
EDITED = 8  # transforms whose places change
EDIT_SECONDS = 0.05  # between two edits
CREATE_EVERY = 20  # edits
MAX_GROUPS = 5  # of what was created; then the oldest is removed


class Expected:
    """What one process renders, for comparison."""

    def __init__(self, programs, backend):
        embedded = ["--backend", backend, "--threads", "2"]
        self.film_hashes = []
        for number, frame in enumerate(FRAMES):
            out, _ = programs.run("render", SCENE, *frame, "--seed", number, *embedded, "-o", programs.scratch / "expected.exr", "--json")
            self.film_hashes.append(json.loads(out)["film_hash"])
        picture = programs.scratch / "expected.png"
        programs.run("render", SCENE, *JOB, *embedded, "-o", picture)
        self.job_pixels = pixels_of(picture.read_bytes())


class Renders:
    """A client that renders one picture after the other; each has to have the expected bits."""

    def __init__(self, world, expected):
        self._world, self._expected = world, expected
        self.process, self.finished, self.killed, self._started = None, 0, 0, 0

    def start(self):
        number = self._started % len(FRAMES)
        self._started += 1
        self.process = self._world.programs.start(
            "tessera", "render", SCENE, *FRAMES[number], "--seed", number, "-o", self._world.folder / f"{self._started}.exr", "--json",
            "--master", self._world.endpoint("render"), "--keys", self._world.keys, out=subprocess.PIPE)
        self.process.number = number

    def step(self, start_another):
        """Whether a picture is still to come."""
        if self.process is None or self.process.poll() is None:
            return self.process is not None
        with self.process.stdout:
            out = self.process.stdout.read()
        if self.process.returncode != 0:
            raise ChaosError(f"a render ended with status {self.process.returncode}:\n{tail(self.process)}")
        hash = json.loads(out)["film_hash"]
        if hash != self._expected.film_hashes[self.process.number]:
            raise ChaosError(f"frame {self.process.number} has other bits: film hash {hash}")
        self.finished += 1
        self.process = None
        if start_another:
            self.start()
        return self.process is not None

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.killed += 1
        self.start()

    def stop(self, number):
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(number)


class Job:
    """A render that no client waits for."""

    def __init__(self, world, expected):
        self._world, self._expected = world, expected
        world.run("render", SCENE, *JOB, "--name", "night", "--detach", "-o", world.folder / "night.png")

    def has_ended(self):
        jobs = json.loads(self._world.run("jobs", "--json"))
        found = [job for job in jobs if job["name"] == "night"]
        if not found:
            raise ChaosError(f"the master has lost a job; it knows {[job['name'] for job in jobs]}")
        return found[0]["ended"]

    def check(self):
        picture = self._world.folder / "fetched.png"
        self._world.run("fetch", "night", "-o", picture)
        if pixels_of(picture.read_bytes()) != self._expected.job_pixels:
            raise ChaosError("the picture of the job differs")


class Editor(threading.Thread):
    """Edits a scene, and remembers what the master has acknowledged."""

    def __init__(self, tessera, world, edit_seconds=EDIT_SECONDS):
        """edit_seconds: between two edits."""
        super().__init__(daemon=True)
        self._tessera, self._end, self._edit_seconds = tessera, threading.Event(), edit_seconds
        self.latencies = []  # s until the master has acknowledged each edit
        self.session = tessera.connect(world.endpoint("editor"), keys=world.keys, name="ann", lost_limit=60.0)
        self.scene = self.session.join("chaos")
        self.places, self.groups, self.edits, self.error = {}, {}, 0, None
        self._create_scene()
        self.pose = tessera.look_at((0, 0, 6), (0, 0, 0))
        self._view = self.session.open_view(self.pose, size=(48, 32), spp=16, picture="planes")

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self.session.close()

    def _create_scene(self):
        with self.session.transaction() as edit:
            material = edit.create("material", name="ember", base_color=(0.8, 0.5, 0.4, 1.0), emission=(0.3, 0.2, 0.1))
            for i in range(EDITED):
                square = dict(indices=[(0, 1, 2), (0, 2, 3)], positions=[(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
                part = edit.create("geometry", name=f"part {i}", material=material, **square)
                place = edit.create("transform", name=f"place {i}", children=[part])
                self.places[place.id] = tuple(place.matrix)

    def run(self):
        try:
            while not self._end.wait(self._edit_seconds):
                begin = time.monotonic()
                self._edit()
                self.latencies.append(time.monotonic() - begin)
        except Exception as error:  # reported by finish()
            self.error = error

    def _edit(self):
        number = self.edits + 1
        if number % CREATE_EVERY == 0:
            name = f"group {number}"
            oldest = next(iter(self.groups)) if len(self.groups) == MAX_GROUPS else None
            with self.session.transaction() as edit:
                group = edit.create("transform", name=name)
                if oldest is not None:
                    edit.detach(oldest)
                    edit.remove(oldest)
            self.groups[group.id] = name
            self.groups.pop(oldest, None)
        else:
            place, matrix = list(self.places)[number % EDITED], self._tessera.translation(0.01 * number % 2, 0.0, -0.1 * number % 3)
            with self.session.transaction() as edit:
                edit.set(place, matrix=matrix)
            self.places[place] = tuple(matrix)
        self.edits = number

    def finish(self):
        self._end.set()
        self.join(120)
        if self.error is not None:
            raise ChaosError(f"an edit failed: {self.error!r}")
        if self.is_alive():
            raise ChaosError("an edit has had no answer for two minutes")

    def check(self, session):
        """That another client sees all that this one was promised."""
        tessera = self._tessera
        transforms = {each.id: each for each in session.join("chaos").all(tessera.Transform)}
        for place, matrix in self.places.items():
            seen = tuple(transforms[place].matrix)
            if seen != matrix:
                raise ChaosError(f"an acknowledged edit is lost: object {place} has the matrix {seen} instead of {matrix}")
        groups = {each.id: each.name for each in transforms.values() if each.name.startswith("group")}
        if groups != self.groups:
            raise ChaosError(f"the scene has the groups {groups}, but acknowledged are {self.groups}")


def wait_until(done, seconds, what):
    until = time.monotonic() + seconds
    while not done():
        if time.monotonic() > until:
            raise ChaosError(f"{what}, after {seconds} s")
        time.sleep(0.1)

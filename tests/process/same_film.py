#!/usr/bin/env python3
"""Renders one list of pictures with one or two builds and compares their film, bit for bit.

Two builds, before and after a change that promises to keep every bit:
    same_film.py BUILD_A/bin BUILD_B/bin [--only TEXT]
One build against the hashes that were recorded for its kind (back-end, version, instruction set, CPU vendor, compiler):
    same_film.py BUILD/bin --recorded film_hashes.json
The same file written anew, for the kinds of this machine; others stay in it:
    same_film.py BUILD/bin --record film_hashes.json

Exit status: 0 equal, 1 different or failed, 64 wrong use. Kinds that the file does not know are named and not compared; the
null back-end is in it for every machine.
"""

import argparse
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import zlib
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))
from ports import free_port  # noqa: E402
SCENES = ROOT / "tests" / "scenes"
FILTERS = ["bilateral", "eaw", "fdf", "gauss", "guided", "nfor", "nlm", "none", "pixel", "psvgf", "statmc"]
PATIENCE = 600  # seconds a single picture may take on a busy machine


@dataclass
class Case:
    name: str
    scene: str
    options: list[str]
    pixels: bool = False  # compares the pixels of a PNG, too
    kill_a_node: bool = False


def sized(width: int, height: int, spp: int) -> list[str]:
    return ["--size", f"{width}x{height}", "--spp", str(spp), "--seed", "5"]


def cases(filters: list[str]) -> list[Case]:
    environment = ["--env", str(SCENES / "env-studio.exr")]
    listed = [Case("demo", "studio-1.glb", environment + sized(320, 180, 16))]
    for scene in ("room-1.glb", "still.glb", "studio-1.glb"):
        listed.append(Case(f"null {scene}", scene, ["--backend", "null"] + sized(96, 54, 16)))
        for renderer in ("path", "whitted"):
            chosen = ["--renderer", renderer]
            listed.append(Case(f"{renderer} {scene}", scene, chosen + sized(160, 90, 16)))
            listed.append(Case(f"vulkan {renderer} {scene}", scene, chosen + ["--backend", "vulkan"] + sized(48, 27, 4)))
    noon = ["--env", str(SCENES / "env-noon.exr")]
    for renderer in ("path", "whitted"):
        chosen = noon + ["--renderer", renderer]
        listed.append(Case(f"{renderer} interior-1.glb", "interior-1.glb", chosen + sized(160, 90, 16)))
        listed.append(Case(f"vulkan {renderer} interior-1.glb", "interior-1.glb", chosen + ["--backend", "vulkan"] + sized(48, 27, 4)))
    sunset = ["--env", str(SCENES / "env-sunset.exr")]
    listed.append(Case("avx2", "studio-1.glb", sunset + ["--reproducible"] + sized(96, 54, 16)))
    listed.append(Case("lens", "studio-1.glb", environment + ["--lens-radius", "0.05"] + sized(96, 54, 16)))
    listed.append(Case("all statistics", "room-1.glb", ["--save-statistics"] + sized(96, 54, 8)))
    listed.append(Case("odd count", "room-1.glb", sized(96, 54, 11)))
    listed.append(Case("transparent", "still.glb", environment + ["--transparent"] + sized(96, 54, 8)))
    for name in filters:
        listed.append(Case(f"filter {name}", "room-1.glb", ["--filter", name] + sized(96, 54, 8), pixels=True))
    listed.append(Case("node killed", "room-1.glb", sized(320, 180, 64), kill_a_node=True))
    return listed


@dataclass
class Outcome:
    kind: str
    film: str
    pixels: str = ""

    def value(self) -> str:
        return self.film + (f"+{self.pixels}" if self.pixels else "")


def pixels_of(png: bytes) -> str:
    """Hash of the rows of a PNG, whatever its compression and metadata are."""
    at, compressed = 8, b""
    while at + 8 <= len(png):
        length, name = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        if name == b"IDAT":
            compressed += png[at + 8:at + 8 + length]
        at += length + 12
    return hashlib.sha256(zlib.decompress(compressed)).hexdigest()[:32]


def finished(words: list[str]) -> str:
    result = subprocess.run(words, capture_output=True, text=True, check=False, timeout=PATIENCE)
    if result.returncode != 0:
        raise RuntimeError(f"{' '.join(words)}: exit status {result.returncode}\n{result.stderr}")
    return result.stdout


def outputs(case: Case, folder: pathlib.Path) -> list[str]:
    return ["-o", str(folder / "out.exr"), *(["-o", str(folder / "out.png")] if case.pixels else [])]


def outcome(report: dict, case: Case, folder: pathlib.Path) -> Outcome:
    kinds = sorted({node["kind"] for node in report["nodes"]})
    if not report["film_hash"]:
        raise RuntimeError(f"{case.name}: the report has no film hash")
    return Outcome("+".join(kinds), report["film_hash"], pixels_of((folder / "out.png").read_bytes()) if case.pixels else "")


@dataclass
class Cluster:
    """A master and two nodes of one build, as processes of their own."""
    programs: pathlib.Path
    folder: pathlib.Path
    children: list[subprocess.Popen] = field(default_factory=list)
    endpoint: str = ""

    def start(self, program: str, *options: str) -> subprocess.Popen:
        log = open(self.folder / f"{program}-{len(self.children)}.log", "w", encoding="utf-8")
        with log:
            child = subprocess.Popen([self.programs / program, *options], stdout=log, stderr=log)
        self.children.append(child)
        return child

    def tool(self, *words: str) -> str:
        at, rest = words[0], words[1:]
        return finished([str(self.programs / "tessera"), at, *rest, "--master", self.endpoint, "--keys", self.keys()])

    def keys(self) -> str:
        return str(self.folder / "keys")

    def __enter__(self) -> "Cluster":
        finished([str(self.programs / "tessera"), "keys", self.keys()])
        try:
            self.start_master()
            for name in ("a", "b"):
                self.start("tessera-node", "--master", self.endpoint, "--keys", self.keys(), "--name", name, "--threads", "1")
        except BaseException:
            self.__exit__()
            raise
        return self

    def start_master(self) -> None:
        """Another process may take a port between its choice and its use, so a master that ends is started at another one."""
        log = self.folder / "tessera-master-0.log"
        for _ in range(5):
            self.endpoint = f"tcp://127.0.0.1:{free_port()}"
            master = self.start("tessera-master", "--listen", self.endpoint, "--keys", self.keys(), "--heartbeat", "0.25")
            until = time.monotonic() + PATIENCE
            while master.poll() is None and time.monotonic() < until:
                if "listening on" in log.read_text(encoding="utf-8"):
                    return
                time.sleep(0.02)
            self.children.remove(master)
            master.kill()
            master.wait()
        raise RuntimeError(f"the master does not start:\n{log.read_text(encoding='utf-8')}")

    def __exit__(self, *_: object) -> None:
        for child in self.children:
            child.kill()
            child.wait()

    def works(self, name: str) -> bool:
        nodes = json.loads(self.tool("status", "--json"))["nodes"]
        return any(node["name"] == name and node.get("units_in_flight", node.get("units_in_hand", 0)) > 0 for node in nodes)


def render_with_a_death(programs: pathlib.Path, case: Case, folder: pathlib.Path) -> Outcome:
    """One of two nodes is killed as soon as it has work."""
    with Cluster(programs, folder) as cluster:
        words = [str(programs / "tessera"), "render", str(SCENES / case.scene), "--master", cluster.endpoint, "--keys",
                 cluster.keys(), "--wait-nodes", "2:60", *outputs(case, folder), "--json", *case.options]
        render = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        cluster.children.append(render)
        until = time.monotonic() + PATIENCE
        while not cluster.works("b"):
            if render.poll() is not None or time.monotonic() > until:
                raise RuntimeError("node b never had work")
        cluster.children[2].kill()
        out, err = render.communicate(timeout=PATIENCE)
        if render.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: exit status {render.returncode}\n{err}")
        report = json.loads(out)
    if report["units"]["reissued"] == 0:
        print("     (node b had finished all that it held)")
    return outcome(report, case, folder)


def render(programs: pathlib.Path, case: Case) -> Outcome:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if case.kill_a_node:
            return render_with_a_death(programs, case, folder)
        words = [str(programs / "tessera"), "render", str(SCENES / case.scene), *outputs(case, folder), "--json",
                 *case.options]
        return outcome(json.loads(finished(words)), case, folder)


def compare_builds(programs: list[pathlib.Path], chosen: list[Case]) -> int:
    different = 0
    for case in chosen:
        a, b = (render(build, case) for build in programs)
        # A render revision in the name of the kind may differ between builds whose bits are the same.
        same = a.value() == b.value()
        different += not same
        print("same" if same else "DIFF", case.name, a.value(), "" if same else b.value(), flush=True)
    print(f"{len(chosen)} pictures, {different} different")
    return 1 if different else 0


def compare_recorded(programs: pathlib.Path, chosen: list[Case], path: pathlib.Path) -> int:
    recorded = json.loads(path.read_text(encoding="utf-8"))
    different, unknown, compared = 0, set(), 0
    for case in chosen:
        got = render(programs, case)
        expected = recorded.get(got.kind, {}).get(case.name)
        if expected is None:
            unknown.add(got.kind)
            continue
        compared += 1
        same = got.value() == expected
        different += not same
        print("same" if same else "DIFF", case.name, got.kind, got.value(), "" if same else f"recorded {expected}", flush=True)
    for kind in sorted(unknown):
        print(f"note: nothing is recorded for some pictures of {kind}")
    print(f"{compared} pictures compared, {different} different")
    return 1 if different or compared == 0 else 0


def record(programs: pathlib.Path, chosen: list[Case], path: pathlib.Path) -> int:
    recorded = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    for case in chosen:
        got = render(programs, case)
        recorded.setdefault(got.kind, {})[case.name] = got.value()
        print(case.name, got.kind, got.value(), flush=True)
    path.write_text(json.dumps(recorded, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", type=pathlib.Path, help="bin folder of a build")
    parser.add_argument("--recorded", type=pathlib.Path, help="compare one build with this file")
    parser.add_argument("--record", type=pathlib.Path, help="write this file from one build")
    parser.add_argument("--only", default="", help="pictures whose names contain this text")
    parser.add_argument("--without", default=None, help="leave out pictures whose names contain this text")
    options = parser.parse_args()
    wanted = 1 if options.recorded or options.record else 2
    if len(options.programs) != wanted:
        parser.error(f"{wanted} bin folder(s) expected, {len(options.programs)} given")
    known = finished([str(options.programs[0] / "tessera"), "filters"])
    chosen = [case for case in cases([name for name in FILTERS if name in known])
              if options.only in case.name and not (options.without and options.without in case.name)]
    if not chosen:
        parser.error(f"no picture is named '{options.only}'")
    if options.recorded:
        return compare_recorded(options.programs[0], chosen, options.recorded)
    if options.record:
        return record(options.programs[0], chosen, options.record)
    return compare_builds(options.programs, chosen)


if __name__ == "__main__":
    sys.exit(main())

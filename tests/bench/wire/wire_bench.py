#!/usr/bin/env python3
"""Measures a cluster on the wire: real processes over TCP with CURVE on this machine, against targets.

  two-nodes  One picture on two nodes with one worker each, through a master, against the same picture in one process with two
             threads (an embedded cluster). Both are rendered in turn, in pairs; the figure is the median of the pairs' ratios of
             rendering time. Both must have the same film, bit for bit.
  film       Bytes of film that the master receives for a pixel, on 1, 2, 4 and 8 nodes with one worker each. A smaller picture
             with fewer samples than that of two-nodes, to bound the time: the ratio to one node is what counts.
  edits      A live scene is edited and watched while two nodes send film through a relay that limits each direction to the rate
             of a network line and adds its latency. The figure is the time from an edit to the first merged picture that shows
             it, as in `tessera status`. Null nodes come first: their film costs no rendering, and fills the line. Then Embree,
             which is limited by this machine's cores.

Targets are ratios and times that hold on any idle machine with at least two cores. A busy one measures its own load.
"""

import argparse
import collections
import json
import os
import pathlib
import platform
import re
import signal
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "process"))
import edits  # noqa: E402
import renders  # noqa: E402
from cluster import ROOT, ClusterError, Programs, load_package  # noqa: E402

EXAMPLES = """\
examples:
  tests/bench/wire/wire_bench.py                       all parts: about 40 minutes on 2 cores, of which two-nodes takes 35
  tests/bench/wire/wire_bench.py film edits            two parts: about 4 minutes
  tests/bench/wire/wire_bench.py two-nodes --pairs 3   fewer pairs
  tests/bench/wire/wire_bench.py edits --line 100      a line of 100 Mbit/s
  tests/bench/wire/wire_bench.py --json wire.json --bin build/release/bin

The part edits needs python3-zmq, python3-protobuf and the Python package of the build: run it with /usr/bin/python3.

exit status:
  0    all targets are met
  1    a target is missed, or two films differ
  2    something was not measured: wrong options, a missing program, a process that ended, a line that was not busy, nodes with
       nothing to render
  130  interrupted; what was measured until then is printed
"""

PARTS = ("two-nodes", "film", "edits")
MAX_TIME_RATIO = 1.05  # two nodes / embedded
MAX_FILM_RATIO = 1.2  # bytes per pixel, any number of nodes / one
MAX_EDIT_SECONDS = 0.150  # p99, from edit to picture
MIN_BUSY = 0.8  # fraction of its rate that the line must carry from null nodes, or the edits met no film

# `met`: None without a target. A condition is not a target: if it is not met, the others of its part were not tested.
Row = collections.namedtuple("Row", "name measured target met is_condition", defaults=("", None, False))


class Progress:
    """One line on the error stream that is written anew; a line every ten seconds where that is no terminal."""

    def __init__(self):
        self._terminal, self._said_at, self.part = sys.stderr.isatty(), -1e9, ""

    def __call__(self, text):
        if self._terminal:
            print(f"\r\033[K{self.part}: {text}", end="", file=sys.stderr, flush=True)
        elif time.monotonic() - self._said_at > 10:
            print(f"{self.part}: {text}", file=sys.stderr, flush=True)
            self._said_at = time.monotonic()

    def clear(self):
        if self._terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def limit(name, value, target, unit="", scale=1.0, digits=3):
    return Row(name, f"{value * scale:.{digits}f}{unit}", f"<= {target * scale:g}{unit}", value <= target)


def same_film(found):
    hashes = found["film_hashes"]
    return Row("films of all renders", "equal" if len(hashes) == 1 else f"{len(hashes)} different", "equal", len(hashes) == 1)


def all_rendered(nodes, rendered):
    """A row, if nodes had nothing to do because the picture is too small to share."""
    if rendered < nodes:
        yield Row("  nodes that rendered", f"{rendered}", f"{nodes}", False, is_condition=True)


def two_nodes_rows(found):
    yield limit("rendering time, cluster / embedded", found["wall_ratio"], MAX_TIME_RATIO)
    yield Row("  from pair to pair", f"{min(found['wall_ratios']):.3f} to {max(found['wall_ratios']):.3f}")
    yield Row("  seconds, cluster and embedded", f"{found['cluster_seconds']:.2f}, {found['embedded_seconds']:.2f}")
    yield Row("processor time, cluster / embedded", f"{found['cpu_ratio']:.3f}")
    yield Row("  seconds, cluster and embedded", f"{found['cluster_cpu_seconds']:.2f}, {found['embedded_cpu_seconds']:.2f}")
    yield Row("whole command, cluster / embedded", f"{found['command_ratio']:.3f}")
    yield from all_rendered(2, found["nodes_rendered"])
    yield same_film(found)


def film_rows(found):
    for row in found["rows"]:
        name = f"{row['nodes']} node{'s' if row['nodes'] > 1 else ''}"
        yield Row(f"{name}, bytes of film per pixel", f"{row['bytes_per_pixel']:.1f}")
        if row is not found["rows"][0]:
            yield limit("  relative to the first", row["ratio"], MAX_FILM_RATIO)
        yield from all_rendered(row["nodes"], row["nodes_rendered"])
    yield same_film(found)


def edits_rows(found):
    for row in found["rows"]:
        name = row["backend"]
        yield limit(f"{name}: edit to picture, p99", row["p99_seconds"], MAX_EDIT_SECONDS, " ms", 1e3, 1)
        yield Row("  p50, p95, longest", ", ".join(f"{1e3 * row[f'{key}_seconds']:.1f}" for key in ("p50", "p95", "longest")) + " ms")
        yield Row("  edits, pictures delivered", f"{row['edits']}, {row['pictures_per_second']:.1f}/s")
        busy = Row("  line to the master, of its rate", f"{100 * row['busy']:.0f} %")
        if name == "null":
            busy = busy._replace(target=f">= {100 * MIN_BUSY:.0f} %", met=row["busy"] >= MIN_BUSY, is_condition=True)
        yield busy
        yield Row("  bytes to the master, to the nodes",
                  f"{row['to_master_bytes_per_second'] * 1e-6:.1f}, {row['to_nodes_bytes_per_second'] * 1e-6:.3f} MB/s")


def measure_edits(programs, options, progress):
    return {"rows": [edits.measure(programs, options, backend, lambda text, name=backend: progress(f"{name}, {text}"))
                     for backend in options.backends]}


def heading(part, options):
    scene, size, film_size = options.scene.name, options.size, options.film_size
    return {
        "two-nodes": f"two-nodes: two nodes with one worker against one process with two threads; {scene}, {size[0]}x{size[1]}, "
                     f"{options.spp} samples per pixel, all channels; median of {options.pairs} pairs",
        "film": f"film: bytes that the master receives; {scene}, {film_size[0]}x{film_size[1]}, {options.film_spp} samples per pixel, all "
                f"channels; median of {options.film_runs}",
        "edits": f"edits: {options.edit_rate:g} a second for {options.seconds:g} s; {scene}, {size[0]}x{size[1]}, two nodes, a line of "
                 f"{options.rate * 1e-6:g} Mbit/s and {options.latency * 1e3:g} ms in each direction",
    }[part]


MEASURE = {"two-nodes": renders.two_nodes, "film": renders.film_bytes, "edits": measure_edits}
ROWS = {"two-nodes": two_nodes_rows, "film": film_rows, "edits": edits_rows}


def print_table(title, rows):
    print(f"\n{title}\n  {'figure':38} {'measured':>22} {'target':>12}  result")
    for row in rows:
        result = "" if row.met is None else "met" if row.met else "too little to test" if row.is_condition else "MISSED"
        print(f"  {row.name:38} {row.measured:>22} {row.target:>12}  {result}".rstrip())
    sys.stdout.flush()


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        model = re.search(r"^model name\s*:\s*(.*)$", file.read(), re.M)
    return f"{os.cpu_count()} cores of {model.group(1) if model else platform.machine()}"


def size_of(text):
    match = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if not match:
        raise argparse.ArgumentTypeError(f"'{text}' is not a size like 1280x720")
    return int(match.group(1)), int(match.group(2))


def at_least(kind, least, may_equal=True):
    def parsed(text):
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not (value >= least if may_equal else value > least):
            raise argparse.ArgumentTypeError(f"'{text}' is not a number {'of at least' if may_equal else 'above'} {least}")
        return value
    return parsed


count, positive = at_least(int, 1), at_least(float, 0.0, may_equal=False)


def counts_of(text):
    return [count(part) for part in text.split(",")]


def backends_of(text):
    names = text.split(",")
    if not set(names) <= {"null", "embree"}:
        raise argparse.ArgumentTypeError(f"'{text}': choose of null, embree")
    return names


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("parts", nargs="*", metavar="PART", help="two-nodes, film, edits (default: all)")
    add("--bin", type=pathlib.Path, default=ROOT / "build" / "release" / "bin", metavar="DIR", help="the programs (build/release/bin)")
    add("--python", type=pathlib.Path, metavar="DIR", help="folder of the Python package (python next to the folder of the programs)")
    add("--scene", type=pathlib.Path, default=ROOT / "tests" / "scenes" / "room-1.glb", metavar="FILE", help="(room-1.glb)")
    add("--size", type=size_of, default=(1280, 720), metavar="WxH", help="pixels, of two-nodes and edits (1280x720)")
    add("--spp", type=count, default=64, metavar="N", help="two-nodes: samples per pixel (64)")
    add("--pairs", type=count, default=9, metavar="N", help="two-nodes: pairs of renders (9)")
    add("--film-size", type=size_of, default=(640, 360), metavar="WxH", help="film: pixels (640x360)")
    add("--film-spp", type=count, default=16, metavar="N", help="film: samples per pixel (16)")
    add("--film-nodes", type=counts_of, default=[1, 2, 4, 8], metavar="N,N,...", help="film: numbers of nodes (1,2,4,8)")
    add("--film-runs", type=count, default=3, metavar="N", help="film: renders for each number of nodes (3)")
    add("--seconds", type=positive, default=30.0, metavar="S", help="edits: duration in s (30)")
    add("--edit-rate", type=positive, default=5.0, metavar="N", help="edits: edits a second (5)")
    add("--line", type=positive, default=1000.0, metavar="MBIT", help="edits: rate of the line in each direction in Mbit/s (1000)")
    add("--latency", type=at_least(float, 0.0), default=0.1, metavar="MS", help="edits: latency of the line in each direction in ms (0.1)")
    add("--backends", type=backends_of, default=["null", "embree"], metavar="NAMES", help="edits: back-ends in turn (null,embree)")
    add("--json", type=pathlib.Path, metavar="FILE", help="also write all figures to this file, times in s, sizes in bytes")
    add("--no-targets", action="store_true", help="exit with 0 even if a target is missed")
    options = parser.parse_args(arguments)
    unknown = [part for part in options.parts if part not in PARTS]
    if unknown:
        parser.error(f"no part is named '{unknown[0]}': choose of {', '.join(PARTS)}")
    options.parts = [part for part in PARTS if part in options.parts or not options.parts]
    if not options.scene.is_file():
        parser.error(f"--scene: there is no file {options.scene}")
    options.scene = options.scene.resolve()
    options.python = options.python or options.bin.resolve().parent / "python"
    options.rate, options.latency = options.line * 1e6, options.latency * 1e-3
    return options


def measure_parts(programs, options, progress, report):
    """Fills the report; what fails is reported there and on the error stream, and the other parts go on."""
    for part in options.parts:
        progress.part = part
        try:
            found = MEASURE[part](programs, options, progress)
        except ClusterError as error:
            progress.clear()
            print(f"wire_bench: {part}: {error}", file=sys.stderr, flush=True)
            report["parts"][part] = {"error": str(error)}
            continue
        rows = list(ROWS[part](found))
        progress.clear()
        print_table(heading(part, options), rows)
        report["parts"][part] = {"title": heading(part, options), **found, "table": [row._asdict() for row in rows]}


def exit_status(report, options):
    parts = report["parts"].values()
    if any("error" in part for part in parts):
        return 2
    missed = [] if options.no_targets else [row for part in parts for row in part["table"] if row["met"] is False]
    if any(not row["is_condition"] for row in missed):
        return 1
    return 2 if missed else 0


def run(options, progress, report):
    if "edits" in options.parts:  # before an hour of renders
        load_package(options.python)
    with Programs(options.bin) as programs:
        report.update({"software": programs.version(), "machine": machine(), "parts": {}})
        print(f"{report['software']}, {report['machine']}", flush=True)
        load, cores = os.getloadavg()[0], os.cpu_count()
        if load > 0.25 * cores:
            print(f"wire_bench: note: this machine is busy (load {load:.1f} on {cores} cores): figures will not be those of the cluster",
                  file=sys.stderr)
        measure_parts(programs, options, progress, report)


def main():
    options = parse(sys.argv[1:])
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends what was started, too
    progress, report, status = Progress(), {"parts": {}}, 2
    try:
        run(options, progress, report)
        status = exit_status(report, options)
    except ClusterError as error:
        print(f"wire_bench: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        progress.clear()
        print("wire_bench: interrupted", file=sys.stderr)
        status = 130
    if options.json:
        options.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main())

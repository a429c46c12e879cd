#!/usr/bin/env python3
"""A live scene for hours, with edits, joins and kills: memory, files and latency have to stay flat.

A master with a session folder and three nodes; a client edits the scene ten times a second and watches it. Every few seconds a
node is killed, leaves or joins, or a line is cut; the master and the node "node-1" live all the time. Each figure is the median
or the 99th percentile of a sixth of the time; the last sixth may not exceed the second one, when caches are full, by more than the
tolerance.

    soak.py BIN_FOLDER PYTHON_FOLDER --minutes 120 --json soak.json

Exit status: 0 flat, 1 something grows or a promise was broken, 64 wrong use.
"""

import contextlib
import json
import os
import pathlib
import statistics
import sys
import time

from chaos import NODES
from command import end_with, new_parser, package
from faults import draw_faults, draw_links
from work import Editor
from world import ChaosError, World

from cluster import ClusterError, Programs

SECONDS_BETWEEN_SAMPLES = 2.0
MEAN_GAP = 4.0  # s between two faults
SIXTHS = 6
EDITS_A_SECOND = 10


def resident_bytes(pid):
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def sizes_below(folder):
    """Bytes of each file; those that the master removes meanwhile are left out."""
    sizes = []
    for path in folder.rglob("*"):
        with contextlib.suppress(FileNotFoundError):
            if path.is_file():
                sizes.append(path.stat().st_size)
    return sizes


def sample(world, editor):
    """Figures of this moment, by name."""
    session = sizes_below(world.folder / "session")
    latencies, editor.latencies = editor.latencies, []
    return {
        "master_bytes": resident_bytes(world.master.child.pid),
        "node_bytes": resident_bytes(world.nodes[NODES[0]].child.pid),
        "master_files": len(os.listdir(f"/proc/{world.master.child.pid}/fd")),
        "session_files": len(session),
        "session_bytes": sum(session),
        "edit_seconds": latencies,
    }


def percentile(values, part):
    return sorted(values)[min(len(values) - 1, int(part * len(values)))] if values else 0.0


def sixth(samples, number):
    """The figures of the sixth of this number, from 0."""
    part = samples[number * len(samples) // SIXTHS:(number + 1) * len(samples) // SIXTHS]
    edits = [seconds for each in part for seconds in each["edit_seconds"]]
    figures = {name: statistics.median(each[name] for each in part) for name in part[0] if name != "edit_seconds"}
    return {**figures, "edit_p50_seconds": percentile(edits, 0.5), "edit_p99_seconds": percentile(edits, 0.99)}


# What the last sixth may exceed the second one by: a factor, and an amount that is never too much.
TOLERANCE = {"master_bytes": (1.05, 16 << 20), "node_bytes": (1.05, 16 << 20), "master_files": (1.0, 4), "session_files": (1.0, 8),
             "session_bytes": (1.5, 32 << 20), "edit_p50_seconds": (1.5, 0.02), "edit_p99_seconds": (2.0, 0.1)}


def growth(early, late):
    """Lines about what is not flat."""
    return [f"{name} grows from {early[name]:.6g} to {late[name]:.6g}" for name, (factor, amount) in TOLERANCE.items()
            if late[name] > max(early[name] * factor, early[name] + amount)]


def soak(world, tessera, options):
    samples, ends = [], []
    faults = [fault for fault in draw_faults(options.seed, 60.0 * options.minutes, NODES, "editor", MEAN_GAP)
              if fault.target not in ("master", NODES[0])]
    with Editor(tessera, world, 1.0 / EDITS_A_SECOND) as editor:
        begin, next_sample = time.monotonic(), 0.0
        while (now := time.monotonic() - begin) < 60.0 * options.minutes:
            world.check()
            while faults and faults[0].at <= now:
                fault = faults.pop(0)
                end = world.begin(fault)
                if end is not None:
                    ends.append((fault.at + fault.seconds, end))
            for due in [each for each in ends if each[0] <= now]:
                ends.remove(due)
                due[1]()
            if now >= next_sample:
                samples.append(sample(world, editor))
                next_sample += SECONDS_BETWEEN_SAMPLES
                if editor.error is not None:
                    raise ChaosError(f"an edit failed: {editor.error!r}")
                if sys.stdout.isatty():
                    print(f"\r{now / 60:.1f} of {options.minutes:g} minutes, {editor.edits} edits, "
                          f"master {samples[-1]['master_bytes'] >> 20} MiB", end="", flush=True)
            time.sleep(0.05)
        for _, end in ends:
            end()
        world.calm()
        editor.finish()
    return samples, editor.edits


def main():
    parser = new_parser(__doc__)
    parser.add_argument("--minutes", type=float, default=120.0, help="how long (120)")
    parser.add_argument("--seed", type=int, default=1, help="of the faults (1)")
    parser.add_argument("--backend", default="embree", help="back-end of the nodes (embree)")
    parser.add_argument("--json", type=pathlib.Path, help="write all figures to this file")
    options = parser.parse_args()
    tessera = package(options)
    try:
        with Programs(options.programs) as programs, World(programs, draw_links(options.seed, [*NODES, "editor"]),
                                                           options.backend) as world:
            samples, edits = soak(world, tessera, options)
    except (ChaosError, ClusterError, tessera.Error) as error:
        print(f"\n{type(error).__name__}: {error}", file=sys.stderr)
        return 1
    sixths = [sixth(samples, number) for number in range(SIXTHS)]
    if options.json:
        options.json.write_text(json.dumps({"minutes": options.minutes, "edits": edits, "sixths": sixths}, indent=1) + "\n", encoding="utf-8")
    print(f"\n{edits} edits in {options.minutes:g} minutes; figures of each sixth:")
    for name in TOLERANCE:
        print(f"{name:18}", *(f"{each[name]:12.6g}" for each in sixths))
    found = growth(sixths[1], sixths[-1])
    print("\n".join(found) or "flat")
    return 1 if found else 0


if __name__ == "__main__":
    end_with(main)

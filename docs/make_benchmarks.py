#!/usr/bin/env python3
"""Writes docs/benchmarks.md from the files that deploy/bench.sh leaves in a folder. Usage: docs/make_benchmarks.py FOLDER VERSION

Every number on the page comes from those files; this script has the sentences between them.
"""

import datetime
import json
import math
import pathlib
import platform
import re
import sys

INTRODUCTION = """\
# Benchmarks

Written by `deploy/bench.sh --docs`, which builds and runs everything here. Each figure is next to the limit that bounds it, measured in
the same run. Compare ratios, not times: they depend on the machine and on what else it does.
"""

# Programs of Google Benchmark: file, heading, what is measured, and the benchmark that is the limit of the others.
MICRO = [
    ("embree", "Rays", "`room-1.glb`, one thread. Embree's own traversal of the same rays is the limit of the path tracer.",
     "bare_bounce_rays"),
    ("film", "Film", "Merging, encoding and decoding film, against a copy in the cache.", "memory_copy"),
    ("filter", "Denoisers", "One picture of 1 megapixel, all cores. `plain_copy` copies as many bytes once.", "plain_copy"),
    ("adaptive", "Adaptive sampling: decisions", "What the master does between two steps of a picture of 1280x720 pixels.",
     None),
    ("compose", "Compositing", "Layers by depth and alpha.", None),
    ("display", "Displays: one output", "What an output does with a frame.", None),
]

# Programs that print tables for readers.
TEXTS = [
    ("kernel", "Cost of features", "Time of the kernel that Embree takes, and of the one with all features, relative to a kernel compiled for "
     "exactly the features of the scene. The scenes below `studio-1` are one room with one rare feature each. Code placement alone "
     "changes single rows by a few per cent from process to process."),
    ("update", "Edits", "Refitting and moving, relative to a rebuild and to a bare commit of Embree."),
    ("light", "Many lights", "Direct light of 10,000 emitters: error at equal time, relative to uniform sampling."),
    ("fog", "Light in media", "Error at equal time of equiangular sampling combined with free flight, relative to free flight alone."),
    ("texture", "Texture filtering", "A checkerboard up to the horizon: error relative to point samples."),
    ("backends", "Back-ends", "All back-ends in turn, with the ratio to the first."),
    ("live", "Live editing", "A master and two nodes as processes with CURVE, `studio-1.glb` at 1280x720."),
    ("wire", "A cluster on the wire", "Processes with one worker each and CURVE, all on the same cores: against one process, the film of more and more "
     "nodes, and edits while film fills a line of 1 Gbit/s. Run again with `tests/bench/wire/wire_bench.py`, which has the targets."),
    ("displays", "Display wall", "24 `tessera-display` processes, a master and two null nodes, all on the same cores; the head moves all the "
     "time, so that every frame is new."),
    ("join", "Joining nodes", "A node joins a scene of 100 MB over a link of 1 Gbit/s; a ratio of 1 is the time of the bytes alone."),
]


def processor():
    for line in open("/proc/cpuinfo", encoding="utf-8"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def machine(version):
    cores = len(re.findall(r"^processor\s*:", open("/proc/cpuinfo", encoding="utf-8").read(), re.M))
    kilobytes = int(re.search(r"MemTotal:\s*(\d+)", open("/proc/meminfo", encoding="utf-8").read()).group(1))
    return (f"{version}, {datetime.date.today().isoformat()}, on {cores} cores of {processor()}, "
            f"{kilobytes / 2**20:.0f} GiB.\n")


def short(value):
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def rate_of(entry):
    """Rate and unit of a benchmark, or nothing."""
    for key, unit in (("items_per_second", "M/s"), ("bytes_per_second", "GB/s")):
        if key in entry:
            return entry[key] / (1e6 if unit == "M/s" else 1e9), unit
    return (entry["GB/s"], "GB/s") if "GB/s" in entry else None


def micro_table(report, limit):
    entries = {re.sub(r"/(real_time|process_time|manual_time|iterations:\d+)", "", entry["name"]): entry for entry in report["benchmarks"]}
    bound = rate_of(entries[limit]) if limit else None
    yield "| benchmark | time | rate | of the limit |\n|---|---|---|---|"
    for name, entry in entries.items():
        rate = rate_of(entry)
        ratio = f"{100 * rate[0] / bound[0]:.0f} %" if rate and bound and rate[1] == bound[1] and name != limit else ""
        yield (f"| `{name}` | {short(entry['real_time'])} {entry['time_unit']} | {short(rate[0]) + ' ' + rate[1] if rate else ''} | "
               f"{'limit' if name == limit else ratio} |")


def quality_rows(report, spp):
    """Error, time and equivalent samples of each denoiser in each scene."""
    yield "| scene | denoiser | relMSE | FLIP | ms | equivalent spp |\n|---|---|---|---|---|---|"
    for scene in report["scenes"]:
        for row in scene["sizes"][0]["rows"]:
            if row["spp"] == spp:
                ratio = row["trimmed"]["equal_error_sample_ratio"]
                yield (f"| `{scene['name']}` | `{row['filter'].split(':')[0]}` | {short(row['trimmed']['relmse']['value'])} | "
                       f"{row['flip_mean']:.3f} | {short(row['filter_milliseconds'])} | {short(ratio['value']) if ratio else ''} |")


def measured(folder, name):
    """A line with the date of a part that is older than the newest one, for pages of which only some parts were renewed."""
    day = {path.name: datetime.date.fromtimestamp(path.stat().st_mtime) for path in folder.glob("*.[jt][sx]*")}
    return f"\nMeasured on {day[name].isoformat()}.\n" if day[name] < max(day.values()) else ""


def consistency_rows(report):
    """How denoisers keep their promise: error, light and specks of each number of samples, over all scenes."""
    yield "| spp | denoiser | relMSE | most | trimmed | most | light | specks | without it |\n|---|---|---|---|---|---|---|---|---|"
    cells = [(cell, scene["scene"]) for scene in report for cell in scene["cells"]]
    for spp in sorted({cell["spp"] for cell, _ in cells}):
        specks = {scene: cell["specks"] for cell, scene in cells if cell["spp"] == spp and cell["filter"] == "none"}
        for name in dict.fromkeys(cell["filter"] for cell, _ in cells if cell["filter"] != "none"):
            of_name = [(cell, scene) for cell, scene in cells if cell["spp"] == spp and cell["filter"] == name]
            row = [str(spp), f"`{name}`"]
            for key in ("relmse_over_unfiltered", "trimmed_relmse_over_unfiltered"):
                ratios = [(cell[key]["mean"], scene + "*" * (cell["rare_light"] > 0.01)) for cell, scene in of_name]
                mean = math.exp(sum(math.log(max(ratio, 1e-9)) for ratio, _ in ratios) / len(ratios))
                row += [f"{mean:.2f}", f"{max(ratios)[0]:.2f} `{max(ratios)[1]}`"]
            light = [cell["energy"] for cell, _ in of_name]
            row.append(f"{min(light):.3f} to {max(light):.3f}")
            row.append(f"{100 * sum(cell['specks'] for cell, _ in of_name) / len(of_name):.1f} %")
            row.append(f"{100 * sum(specks.values()) / len(specks):.1f} %")
            yield "| " + " | ".join(row) + " |"


def variance_rows(report):
    yield "| scene | spp | blocks | in 0.7 to 2 | smallest | median | largest | picture | as if independent |\n|---|---|---|---|---|---|---|---|---|"
    for scene in report:
        for row in scene["rows"]:
            yield (f"| `{scene['scene']}` | {row['spp']} | {row['blocks']} | {100 * row['within']:.0f} % | {row['smallest']:.2f} | "
                   f"{row['median']:.2f} | {row['largest']:.2f} | {row['picture']:.2f} | {row['picture_independent']:.2f} |")


def adaptive_rows(report):
    yield "| scene | stops at | spp | gain | trimmed | light | true noise | decisions | masked units |\n|---|---|---|---|---|---|---|---|---|"
    for scene in report:
        for row in scene["rows"]:
            stop = f"noise {row['noise']:g}" if row["noise"] else "samples"
            noise = sorted(row["true_noise"])
            yield (f"| `{scene['scene']}` | {stop} | {short(row['spp'])} | {row['gain']:.2f} | {row['trimmed_gain']:.2f} | {row['light']:.3f} | "
                   f"{noise[0]:.2f} to {noise[-1]:.2f} | {100 * row['deciding']:.1f} % | {scene['masked_rate']:.2f} |")


def adaptive_error_rows(report):
    yield "| scene | error | spp | gain | trimmed | light | true error | decisions |\n|---|---|---|---|---|---|---|---|"
    for scene in report:
        for row in scene["rows"]:
            if not row["error"]:
                continue
            error = sorted(row["true_error"])
            yield (f"| `{scene['scene']}` | {row['error']:g} | {short(row['spp'])} | {row['gain']:.2f} | {row['trimmed_gain']:.2f} | {row['light']:.3f} | "
                   f"{error[0]:.2f} to {error[-1]:.2f} | {100 * row['deciding']:.1f} % |")


def transport_rows(report):
    yield "| scene | renderer | relMSE | HDR-FLIP | rays per sample | Mrays/s | Msamples/s | slope | light in 0.1 % of the samples | time to equal error, Cycles = 1 |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for scene in report["scenes"]:
        for curve in scene["curves"]:
            last = curve["points"][-1]
            rays = f"{last['rays_per_sample']:.2f} | {last['mrays_per_second']:.2f}" if last["rays_per_sample"] else " | "
            slope = f"{curve['slope']:.2f}" if curve["slope"] else ""  # none of a single number of samples
            ratio, rare = curve["time_to_equal_error_over_cycles"], curve["light_in_brightest_permille"]
            yield (f"| `{scene['scene']}` | {curve['renderer']} | {short(last['relmse'])} | {last['hdr_flip']:.4f} | {rays} | "
                   f"{last['msamples_per_second']:.3f} | {slope} | {f'{100 * rare:.1f} %' if rare else ''} | "
                   f"{f'{ratio:.2f}' if ratio else ''} |")
    for renderer, ratio in report["mean_time_to_equal_error_over_cycles"].items():
        if ratio:
            yield f"| geometric mean | {renderer} | | | | | | | | {ratio:.2f} |"


def depth_rows(report):
    """Noise, light and time by the lengths of paths, each over those of whole paths."""
    yield "| scene | noise: direct light, bounce 1, bounce 2, others | light | time |"
    yield "|---|---|---|---|"
    for scene in report["scenes"]:
        depths = next((curve["depths"] for curve in scene["curves"] if curve["depths"]), None)
        if depths:
            yield f"| `{scene['scene']}` | {' | '.join(parts(depths, key) for key in ('noise', 'light', 'seconds'))} |"


def parts(depths, key):
    """What each length adds, in percent. The films are independent, so that a part may be negative."""
    shares = [100 * depth[key] / depths[-1][key] for depth in depths]
    return ", ".join(f"{after - before:.0f} %" for before, after in zip([0, *shares], shares))


def page(folder, version):
    yield INTRODUCTION
    yield machine(version)
    for name, heading, text, limit in MICRO:
        yield f"## {heading}\n\n{text}\n{measured(folder, name + '.json')}"
        yield "\n".join(micro_table(json.loads((folder / f"{name}.json").read_text()), limit)) + "\n"
    quality = json.loads((folder / "filters.json").read_text())
    size = quality["scenes"][0]["sizes"][0]
    yield ("## Denoisers: error\n\n"
           f"Films of 4 samples per pixel, {size['width']}x{size['height']}. relMSE leaves out the worst 0.1 % of the pixels; *equivalent spp* is how many "
           "times the samples a picture without a denoiser needs for the same error.\n")
    yield "\n".join(quality_rows(quality, 4)) + "\n"
    consistency = json.loads((folder / "consistency.json").read_text())
    yield ("## Denoisers: what consistent means\n\n"
           f"Over {', '.join('`' + scene['scene'] + '`' for scene in consistency)} (96x54, several seeds): relMSE over that of the same samples "
           "without a denoiser, as geometric mean and in the worst scene, with and without the worst 0.1 % of the pixels; the part of the light that "
           "is kept; and pixels that are specks, on average. A star marks scenes where more than 1 % of the light is too rare to be known at that "
           "number of samples.\n")
    yield "\n".join(consistency_rows(consistency)) + "\n"
    yield ("## Accuracy of variances\n\n"
           "Estimates of single films over the true variance, from 12 seeds, in blocks of 16x16 pixels that expect at least three finds per 5x5; of the "
           "whole picture; and of that as if samples were not stratified. 1 is exact.\n")
    yield "\n".join(variance_rows(json.loads((folder / "variance.json").read_text()))) + "\n"
    adaptive = json.loads((folder / "adaptive_sampling.json").read_text())
    yield ("## Adaptive sampling\n\n"
           "relMSE of uniform samples over that of as many where they are needed, with and without the worst 0.1 % of the pixels (96x54, several seeds); "
           "mean light over that of uniform samples; the true noise over the wanted one (over its estimate where the samples are given); the part "
           "of the time that decisions take; and samples per second of units with a quarter of the pixels, relative to whole tiles.\n"
           f"{measured(folder, 'adaptive_sampling.json')}")
    yield "\n".join(adaptive_rows(adaptive)) + "\n"
    errors = json.loads((folder / "adaptive_error.json").read_text())
    yield ("## Adaptive sampling until an error of the denoised picture\n\n"
           "The same for pictures of `fdf` that end at an error (`--denoise --error`): relMSE of as many uniform samples, denoised likewise, over "
           "theirs, and their true relMSE over the wanted one. The picture is small, and its samples are few: decisions take a larger part of the "
           f"time than in a large one.\n{measured(folder, 'adaptive_error.json')}")
    yield "\n".join(adaptive_error_rows(errors)) + "\n"
    yield from transport_section(folder)
    for name, heading, text in TEXTS:
        output = "\n".join(line.rstrip() for line in (folder / f"{name}.txt").read_text().strip().split("\n"))
        yield f"## {heading}\n\n{text}\n{measured(folder, name + '.txt')}\n```\n{output}\n```\n"


def transport_section(folder):
    transport = json.loads((folder / "transport.json").read_text())
    spp = transport["scenes"][0]["curves"][0]["points"][-1]["spp"]
    yield ("## Light transport\n\n"
           f"Unfiltered pictures of {transport['width']}x{transport['height']} at {spp} samples per pixel: relMSE against two references of "
           f"{transport['reference_spp']}, how fast it falls with the samples (slope of the logarithms), and relMSE times seconds over that of "
           "Blender's Cycles, which has the same scene with its own materials and so its own references. `tessera bench transport` writes a page with "
           "all numbers.\n\n![relMSE over seconds](transport.svg)\n"
           f"{measured(folder, 'transport.json')}")
    yield "\n".join(transport_rows(transport)) + "\n"
    yield ("Where the noise comes from, and where the time goes: what direct light, the first bounce, the second and all others add, measured with paths that "
           "end there. Such films are independent, so a part can be negative.\n")
    yield "\n".join(depth_rows(transport)) + "\n"


def main():
    print("\n".join(page(pathlib.Path(sys.argv[1]), sys.argv[2])), end="")


main()

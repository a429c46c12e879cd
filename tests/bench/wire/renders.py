"""Renders of one picture: on a cluster of real processes against one process, and on more and more nodes."""

import json
import statistics

from cluster import Cluster


class Render:
    """What `tessera render --json` reports, and the processor time of all processes that took part, in s."""

    def __init__(self, out, cpu_seconds):
        report = json.loads(out)
        self.seconds, self.command_seconds = report["seconds_render"], report["seconds_total"]
        self.cpu_seconds = cpu_seconds
        self.film_hash, self.film_bytes = report["film_hash"], report["wire_bytes"]["film"]
        self.kinds = sorted({node["kind"] for node in report["nodes"]})
        self.nodes, self.units = len(report["nodes"]), report["units"]


def words(programs, scene, size, spp):
    """The options of a render; an EXR has all channels that a denoiser wants, and its film is the largest."""
    return [scene, "--size", f"{size[0]}x{size[1]}", "--spp", spp, "-o", programs.scratch / "picture.exr", "--json"]


def on_cluster(cluster, nodes, render_words):
    before = cluster.cpu_seconds()
    out, client_seconds = cluster.run("render", *render_words, "--wait-nodes", f"{nodes}:60")
    return Render(out, cluster.cpu_seconds() - before + client_seconds)


def embedded(programs, threads, render_words):
    return Render(*programs.run("render", *render_words, "--threads", threads))


def two_nodes(programs, options, progress):
    """Pairs of the same render, on two nodes with one worker and embedded with two threads; both orders in turn, so that a machine
    that becomes slower or faster does not favour one. Ratios are cluster / embedded: the medians of those of the pairs."""
    job = words(programs, options.scene, options.size, options.spp)
    pairs = []
    with Cluster(programs, 2) as cluster:
        progress("warm-up")
        warm = words(programs, options.scene, (options.size[0] // 4, options.size[1] // 4), 4)
        cluster.run("render", *warm, "--wait-nodes", "2:60")
        embedded(programs, 2, warm)
        for i in range(options.pairs):
            pair = {}
            for place in ("cluster", "embedded") if i % 2 == 0 else ("embedded", "cluster"):
                progress(f"pair {i + 1} of {options.pairs}, {place}")
                pair[place] = on_cluster(cluster, 2, job) if place == "cluster" else embedded(programs, 2, job)
            pairs.append(pair)
            progress(f"pair {i + 1} of {options.pairs}: cluster / embedded = {pair['cluster'].seconds / pair['embedded'].seconds:.3f}")

    def ratios(name):
        return [getattr(pair["cluster"], name) / getattr(pair["embedded"], name) for pair in pairs]

    def median(place, name):
        return statistics.median(getattr(pair[place], name) for pair in pairs)

    rendered = [pair[place] for pair in pairs for place in pair]
    wall = ratios("seconds")
    return {
        "pairs": len(pairs), "wall_ratio": statistics.median(wall), "wall_ratios": wall,
        "cpu_ratio": statistics.median(ratios("cpu_seconds")), "command_ratio": statistics.median(ratios("command_seconds")),
        "cluster_seconds": median("cluster", "seconds"), "embedded_seconds": median("embedded", "seconds"),
        "cluster_cpu_seconds": median("cluster", "cpu_seconds"), "embedded_cpu_seconds": median("embedded", "cpu_seconds"),
        "cluster_film_bytes": median("cluster", "film_bytes"), "nodes_rendered": min(pair["cluster"].nodes for pair in pairs),
        "film_hashes": sorted({each.film_hash for each in rendered}), "kinds": sorted({kind for each in rendered for kind in each.kinds}),
    }


def film_bytes(programs, options, progress):
    """Bytes of film that the master receives for a pixel, on each number of nodes: the medians of options.film_runs renders."""
    job = words(programs, options.scene, options.film_size, options.film_spp)
    pixels = options.film_size[0] * options.film_size[1]
    rows, hashes = [], set()
    for nodes in options.film_nodes:
        with Cluster(programs, nodes) as cluster:
            runs = []
            for i in range(options.film_runs):
                progress(f"{nodes} node{'s' if nodes > 1 else ''}, render {i + 1} of {options.film_runs}")
                runs.append(on_cluster(cluster, nodes, job))
        hashes.update(run.film_hash for run in runs)
        rows.append({"nodes": nodes, "bytes_per_pixel": statistics.median(run.film_bytes for run in runs) / pixels,
                     "nodes_rendered": min(run.nodes for run in runs), "seconds": statistics.median(run.seconds for run in runs),
                     "units_duplicate": statistics.median(run.units["duplicate"] for run in runs)})
    for row in rows:
        row["ratio"] = row["bytes_per_pixel"] / rows[0]["bytes_per_pixel"]
    return {"rows": rows, "film_hashes": sorted(hashes)}

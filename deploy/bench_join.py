#!/usr/bin/env python3
"""How long a node needs to join a scene of 100 MB over a line of 1 Gbit/s: cold, then again with its cache.

The node runs in its own network namespace behind a rate limit (tbf), so this needs root and iproute2. Its back-end
is `null`: the transfer of the scene is measured, not the build of a BVH. Run by deploy/bench.sh, or:

    PYTHONPATH=build/release/python /usr/bin/python3 deploy/bench_join.py build/release/bin
"""

import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

import tessera

MEGABYTES = 100
RATE = 1e9  # bits per second
NAMESPACE, NEAR, FAR = "tessera-join", "tsr-near", "tsr-far"
HERE, THERE = "10.213.71.1", "10.213.71.2"


def run(*words):
    subprocess.run(words, check=True, capture_output=True)


def make_line():
    run("ip", "netns", "add", NAMESPACE)
    run("ip", "link", "add", NEAR, "type", "veth", "peer", "name", FAR, "netns", NAMESPACE)
    run("ip", "addr", "add", f"{HERE}/30", "dev", NEAR)
    run("ip", "link", "set", NEAR, "up")
    run("ip", "netns", "exec", NAMESPACE, "ip", "addr", "add", f"{THERE}/30", "dev", FAR)
    run("ip", "netns", "exec", NAMESPACE, "ip", "link", "set", FAR, "up")
    run("tc", "qdisc", "add", "dev", NEAR, "root", "tbf", "rate", f"{int(RATE)}bit", "burst", "256kb", "latency", "50ms")


def sent_bytes():
    return int(pathlib.Path(f"/sys/class/net/{NEAR}/statistics/tx_bytes").read_text())


def join(programs, folder, endpoint, session, version):
    """Seconds from the node's start until it has the version, and the bytes sent over the line."""
    before, start = sent_bytes(), time.monotonic()
    node = subprocess.Popen(
        ["ip", "netns", "exec", NAMESPACE, programs / "tessera-node", "--master", endpoint, "--keys", folder / "keys",
         "--backend", "null", "--threads", "1", "--cache", folder / "cache"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while time.monotonic() - start < 120:
            nodes = session.status().nodes
            if nodes and nodes[0].version >= version:
                return time.monotonic() - start, sent_bytes() - before
            time.sleep(0.005)
        raise SystemExit("the node did not join within two minutes")
    finally:
        node.send_signal(signal.SIGTERM)
        node.wait()


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    if os.geteuid() != 0:
        print("join: skipped: needs root for a network namespace")
        return
    endpoint = f"tcp://{HERE}:{20000 + random.randrange(5000) * 2}"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(programs / "tessera", "keys", folder / "keys")
        make_line()
        master = None
        try:
            master = subprocess.Popen([programs / "tessera-master", "--listen", endpoint, "--keys", folder / "keys"],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            with tessera.connect(endpoint, keys=str(folder / "keys"), name="join") as session:
                session.join("join")
                positions = bytearray(random.Random(1).randbytes(MEGABYTES * 1_000_000 // 12 * 12))
                positions[3::4] = b"\x3f" * (len(positions) // 4)  # floats near 1
                with session.transaction() as edit:
                    edit.create("geometry", name="cloud", indices=[(0, 1, 2)], positions=bytes(positions))
                session.refresh()  # the scene is published now
                version = session.status().version
                ideal = 8 * len(positions) / RATE
                for label in ("cold", "with its cache"):
                    seconds, line_bytes = join(programs, folder, endpoint, session, version)
                    print(f"join {label:15} {seconds:6.2f} s, {seconds / ideal:5.2f} x the time of the scene's bytes "
                          f"({ideal:.2f} s), {line_bytes / 1e6:7.2f} MB over the line "
                          f"({100 * line_bytes / len(positions):.1f} %)")
                    while session.status().nodes:
                        time.sleep(0.1)
        finally:
            if master:
                master.kill()
                master.wait()
            subprocess.run(["ip", "link", "del", NEAR], check=False, capture_output=True)
            subprocess.run(["ip", "netns", "del", NAMESPACE], check=False, capture_output=True)


main()

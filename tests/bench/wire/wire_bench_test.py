#!/usr/bin/env python3
"""wire_bench.py at tiny sizes, and the line that it limits. Usage: wire_bench_test.py BIN_FOLDER PYTHON_FOLDER"""

import hashlib
import json
import pathlib
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "process"))
from cluster import ROOT, free_port  # noqa: E402
from edits import durations, percentile  # noqa: E402
from line import BURST_SECONDS, CHUNK, Line  # noqa: E402

PYTHON = pathlib.Path(sys.argv.pop()).resolve()
PROGRAMS = pathlib.Path(sys.argv.pop()).resolve()
SCRIPT = ROOT / "tests" / "bench" / "wire" / "wire_bench.py"
PAYLOAD = random.Random(1).randbytes(1_000_000)
EDITS_PER_SECOND, SECONDS, LINE_MBIT = 10, 1, 40
SMALL = ["--size", "96x64", "--spp", "4", "--pairs", "1", "--film-size", "64x64", "--film-spp", "4", "--film-nodes", "1,2", "--film-runs",
         "1", "--seconds", SECONDS, "--edit-rate", EDITS_PER_SECOND, "--line", LINE_MBIT, "--backends", "null"]


class LineTest(unittest.TestCase):
    def setUp(self):
        self.server = socket.create_server(("127.0.0.1", free_port()))
        self.addCleanup(self.server.close)

    def line(self, **more):
        port = free_port()
        line = Line(port, self.server.getsockname()[1], ports=1, **more)
        self.addCleanup(line.close)
        near = socket.create_connection(("127.0.0.1", port))
        far = self.server.accept()[0]
        for end in (near, far):
            end.settimeout(60)
            self.addCleanup(end.close)
        return line, near, far

    @staticmethod
    def received(end):
        parts = []
        while part := end.recv(1 << 16):
            parts.append(part)
        return b"".join(parts)

    def pass_through(self, near, far):
        """Sends the payload from end to end. Returns what arrived."""
        def send():
            near.sendall(PAYLOAD)
            near.shutdown(socket.SHUT_WR)
        sender = threading.Thread(target=send)
        sender.start()
        arrived = self.received(far)
        sender.join()
        return arrived

    def test_bytes_arrive_unchanged_and_no_faster_than_the_rate(self):
        rate = 2e7
        for direction in ("to_master", "to_nodes"):
            with self.subTest(direction):
                line, near, far = self.line(rate=rate)
                before = line.counts()
                arrived = self.pass_through(*((near, far) if direction == "to_master" else (far, near)))
                after = line.counts()
                self.assertEqual(hashlib.sha256(arrived).digest(), hashlib.sha256(PAYLOAD).digest())
                self.assertEqual(getattr(after, direction) - getattr(before, direction), len(PAYLOAD))
                shortest = 8 * (len(PAYLOAD) - CHUNK) / rate - BURST_SECONDS
                self.assertGreater(after.at - before.at, shortest)

    def test_connections_share_the_rate(self):
        rate = 4e7
        line, near, far = self.line(rate=rate)
        other_near = socket.create_connection(near.getpeername())
        other_far = self.server.accept()[0]
        before = time.monotonic()
        other = threading.Thread(target=self.pass_through, args=(other_near, other_far))
        other.start()
        self.pass_through(near, far)
        other.join()
        self.assertGreater(time.monotonic() - before, 8 * (2 * len(PAYLOAD) - CHUNK) / rate - BURST_SECONDS)
        for end in (other_near, other_far):
            end.close()

    def test_each_direction_adds_its_latency(self):
        _, near, far = self.line(latency=0.05)
        before = time.monotonic()
        near.sendall(b"ping")
        far.sendall(far.recv(4))
        self.assertEqual(near.recv(4), b"ping")
        self.assertGreaterEqual(time.monotonic() - before, 0.1)

    def test_what_is_held_passes_on_later(self):
        line, near, far = self.line()
        line.hold()
        near.sendall(b"late")
        far.settimeout(0.1)
        with self.assertRaises(TimeoutError):
            far.recv(4)
        line.go_on()
        far.settimeout(60)
        self.assertEqual(far.recv(4), b"late")

    def test_forgotten_connections_stay_silent_and_those_that_are_cut_end(self):
        line, near, far = self.line()
        line.forget()
        line.go_on()
        near.sendall(b"lost")
        far.settimeout(0.1)
        with self.assertRaises(TimeoutError):
            far.recv(4)
        with socket.create_connection(near.getpeername()) as new_near, self.server.accept()[0] as new_far:
            new_near.sendall(b"news")
            self.assertEqual(new_far.recv(4), b"news")
            line.cut()
            self.assertEqual(new_far.recv(1), b"")

    def test_the_end_of_a_connection_is_passed_on(self):
        line, near, far = self.line()
        near.close()
        self.assertEqual(far.recv(1), b"")
        line.close()
        line.close()


class FiguresTest(unittest.TestCase):
    def test_percentiles_are_of_the_nearest_rank(self):
        values = [float(i) for i in range(100, 0, -1)]
        self.assertEqual([percentile(values, part) for part in (0.5, 0.95, 0.99, 1.0)], [50, 95, 99, 100])
        self.assertEqual(percentile([3.0], 0.99), 3.0)

    def test_durations_are_those_of_one_client_with_edits_that_have_no_picture(self):
        def event(phase, name, edit, at, **more):
            return {"ph": phase, "name": name, "id": edit, "ts": at, **more}
        events = [event("b", "transaction 1 to master", 0, 0.0, args={"by": "loader"}),
                  event("e", "transaction 1 to picture", 0, 9.0),
                  event("b", "transaction 2 to master", 1, 10.0, args={"by": "editor"}),
                  event("b", "transaction 2 to picture", 1, 20.0, args={"by": "editor"}),
                  event("e", "transaction 2 to picture", 1, 50_010.0),
                  event("b", "transaction 3 to master", 2, 30.0, args={"by": "editor"}),
                  {"ph": "M", "name": "process_name"}]
        shown, missing = durations({"traceEvents": events}, "editor")
        self.assertAlmostEqual(shown, 0.05)
        self.assertIsNone(missing)


class BenchTest(unittest.TestCase):
    def bench(self, *options):
        return subprocess.run([sys.executable, SCRIPT, "--bin", PROGRAMS, "--python", PYTHON, *map(str, options)], capture_output=True,
                              text=True, timeout=240)

    def test_all_parts_give_plausible_figures(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "wire.json"
            done = self.bench(*SMALL, "--no-targets", "--json", path)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            report = json.loads(path.read_text())
        self.assertEqual(list(report["parts"]), ["two-nodes", "film", "edits"])
        for part in report["parts"]:
            self.assertIn(f"\n{part}: ", done.stdout)
        pair, film, (edits,) = report["parts"]["two-nodes"], report["parts"]["film"]["rows"], report["parts"]["edits"]["rows"]
        self.assertEqual(len(pair["film_hashes"]), 1)
        self.assertEqual(len(pair["wall_ratios"]), 1)
        for name in ("wall_ratio", "cpu_ratio", "command_ratio"):
            self.assertGreater(pair[name], 0.01)
            self.assertLess(pair[name], 100)
        self.assertEqual([row["nodes"] for row in film], [1, 2])
        for row in film:
            # All channels have 27 planes of 4 bytes; each of the four samples may come as a film of its own.
            self.assertGreater(row["bytes_per_pixel"], 100)
            self.assertLess(row["bytes_per_pixel"], 500)
        self.assertEqual(edits["edits"], EDITS_PER_SECOND * SECONDS)
        self.assertEqual(edits["stages"]["whole"]["count"], edits["edits"])
        self.assertLessEqual(edits["p50_seconds"], edits["p95_seconds"])
        self.assertLessEqual(edits["p99_seconds"], edits["longest_seconds"])
        self.assertGreater(edits["to_master_bytes_per_second"], 0)
        self.assertGreater(edits["to_nodes_bytes_per_second"], 0)
        self.assertLessEqual(edits["busy"], 1.1)

    def test_wrong_use_is_refused_with_a_reason(self):
        for options, reason in ((["cables"], "choose of two-nodes, film, edits"), (["--size", "big"], "not a size"),
                                (["--pairs", "0"], "of at least 1"), (["--scene", "none.glb"], "there is no file none.glb"),
                                (["film", "--bin", "/"], "no tessera, tessera-master, tessera-node in /"),
                                (["edits", "--python", "/"], "the Python package 'tessera' cannot be used")):
            with self.subTest(options=options):
                done = self.bench(*options)
                self.assertEqual(done.returncode, 2)
                self.assertIn(reason, done.stderr)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""Links that fall silent, are cut, or are slow, between real processes: the bits stay the same. Usage: links_test.py BIN_FOLDER"""

import contextlib
import json
import pathlib
import subprocess
import sys
import time
import unittest

from cluster import ROOT, Cluster, Programs, free_port
from line import Line

PROGRAMS = pathlib.Path(sys.argv.pop()).resolve()
SCENE = ROOT / "tests" / "scenes" / "still.glb"
SAMPLES = 128 * 96 * 12  # of FRAME, 3 s of one slow node
FRAME = ["--size", "128x96", "--spp", "12", "--seed", "5"]
SLOW_NODE = ["--backend", "null", "--simulate-cost", "20us"]
QUICK = ["--heartbeat", "0.25"]  # a peer is gone after 0.75 s
PATIENCE = 120  # s that anything may take on a busy machine


class LinksTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.programs = cls.enterClassContext(Programs(PROGRAMS))
        out, _ = cls.programs.run("render", SCENE, *FRAME, "--backend", "null", "-o", cls.programs.scratch / "one.exr", "--json")
        cls.expected = json.loads(out)["film_hash"]

    def setUp(self):
        self.cluster = self.enterContext(Cluster(self.programs, 0, master_options=QUICK))

    def line(self, **more):
        """A line to the master, and its port."""
        port = free_port()
        return self.enterContext(Line(port, self.cluster.port, **more)), port

    def start_render(self, *options, port=None):
        return self.programs.start("tessera", "render", SCENE, *FRAME, "-o", self.programs.scratch / "frame.exr", "--json", "--master",
                                   f"tcp://127.0.0.1:{port or self.cluster.port}", "--keys", self.cluster.keys, *options,
                                   out=subprocess.PIPE)

    def finish(self, render):
        """Its report, after a check of the bits."""
        with render.stdout:
            out, _ = render.communicate(timeout=PATIENCE)
        self.assertEqual(render.returncode, 0, render.log.read_text())
        report = json.loads(out)
        self.assertEqual(report["film_hash"], self.expected)
        return report

    def wait_for(self, done, what):
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            status = self.cluster.status()
            if done(status):
                return status
        self.fail(f"{what}: {json.dumps(status, indent=1)}")

    def wait_for_work(self, name):
        self.wait_for(lambda status: any(node["name"] == name and node["units_in_flight"] > 0 for node in status["nodes"]),
                      f"{name} gets no work")

    def wait_for_nodes(self, *names):
        self.wait_for(lambda status: sorted(node["name"] for node in status["nodes"]) == sorted(names), f"not just {names}")

    def master_log(self):
        return self.cluster.master.log.read_text()

    def test_a_node_whose_link_falls_silent_is_removed_and_comes_back(self):
        for holding in (True, False):  # a cable that is plugged in again, a firewall that has lost its state
            with self.subTest(holding=holding), contextlib.ExitStack() as stack:
                line, port = self.line()
                far = self.cluster.start_node("far", *SLOW_NODE, port=port)
                stack.callback(self.programs.stop, [far])
                near = self.cluster.start_node("near", *SLOW_NODE)
                stack.callback(self.programs.stop, [near])
                render = self.start_render("--wait-nodes", "2:60")
                self.wait_for_work("far")
                (line.hold if holding else line.forget)()
                if holding:
                    self.wait_for_nodes("near")
                report = self.finish(render)
                self.assertIn("node far is gone: silent for too long", self.master_log())
                self.assertGreater(report["units"]["reissued"], 0)
                status = self.cluster.status()
                self.assertGreater(status["lost_nodes"], 0)
                self.assertGreater(sum(node["film_bytes"] for node in status["nodes"]), 0)
                line.go_on()
                self.wait_for_nodes("near", "far")
                self.finish(self.start_render("--wait-nodes", "2:60"))

    def test_the_only_node_finishes_its_frame_over_new_connections(self):
        line, port = self.line()
        self.cluster.start_node("far", *SLOW_NODE, port=port)
        render = self.start_render()
        self.wait_for_work("far")
        line.forget()
        report = self.finish(render)
        self.assertIn("node far is gone: silent for too long", self.master_log())
        self.assertGreater(report["units"]["lost"], 0)

    def test_film_that_no_longer_arrives_is_rendered_by_others(self):
        port = free_port()
        self.enterContext(Line(port, self.cluster.port, ports=1))
        bulk = self.enterContext(Line(port + 1, self.cluster.port + 1, ports=1))
        self.cluster.start_node("far", *SLOW_NODE, port=port)
        self.cluster.start_node("near", *SLOW_NODE)
        render = self.start_render("--wait-nodes", "2:60")
        self.wait_for_work("far")
        bulk.hold()  # heartbeats go on
        report = self.finish(render)
        self.assertGreater(report["units"]["reissued"], 0)
        bulk.go_on()
        self.wait_for_nodes("near", "far")
        self.finish(self.start_render("--wait-nodes", "2:60"))

    def test_a_client_whose_link_falls_silent_continues_where_it_was(self):
        line, port = self.line()
        self.cluster.start_node("near", *SLOW_NODE)
        render = self.start_render(port=port)
        self.wait_for_work("near")
        line.hold()
        self.wait_for(lambda status: status["sessions"] == 1, "the client is not given up")
        self.wait_for_work("near")  # its frame goes on
        self.assertEqual(self.cluster.status()["lost_sessions"], 1)
        line.go_on()
        report = self.finish(render)
        self.assertEqual(sum(node["samples"] for node in report["nodes"]), SAMPLES, "something was rendered twice")

    def test_links_that_are_cut_change_nothing(self):
        line, port = self.line()
        self.cluster.start_node("far", *SLOW_NODE, port=port)
        self.cluster.start_node("near", *SLOW_NODE)
        render = self.start_render("--wait-nodes", "2:60", port=port)  # the client's link is cut, too
        for _ in range(3):
            self.wait_for_work("far")
            line.cut()
            time.sleep(0.3)
        self.finish(render)
        self.wait_for_nodes("near", "far")

    def test_a_node_on_a_slow_link_takes_part(self):
        line, port = self.line(rate=20e6, latency=0.02)
        self.cluster.start_node("far", "--backend", "null", port=port)  # renders faster than the line carries film
        render = self.start_render()
        self.finish(render)
        self.assertGreater(line.counts().to_master, 128 * 96 * 100)
        for word in ("is stuck", "is gone", "quarantine"):
            self.assertNotIn(word, self.master_log())


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""Programs that wait use no processor: without a master, without work, and while their workers render. They end when asked to.

Usage: idle_test.py BIN_FOLDER
"""

import pathlib
import signal
import subprocess
import sys
import time
import unittest

from cluster import ROOT, TICKS, Cluster, Programs, cpu_seconds, free_port

PROGRAMS = pathlib.Path(sys.argv.pop()).resolve()
SCENE = ROOT / "tests" / "scenes" / "still.glb"
WATCHED = 2.0  # s
MOST = 0.05  # of one processor
START = 1.5  # s until a program has started; a busy machine may need longer, hence more than one try
TRIES = 4


def loop_seconds(pid):
    """Processor time of the first thread, which runs the loop."""
    with open(f"/proc/{pid}/task/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


class IdleTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.programs = cls.enterClassContext(Programs(PROGRAMS))
        cls.keys = cls.programs.scratch / "lonely"
        cls.programs.run("keys", cls.keys)

    def start(self, program, *options):
        child = self.programs.start(program, *options, out=subprocess.DEVNULL)
        self.addCleanup(self.programs.stop, [child])
        return child

    def check(self, *children, most=MOST, measure=cpu_seconds):
        """That they sleep, at the latest after a few tries."""
        shares = []
        for _ in range(TRIES):
            time.sleep(START)
            before, begin = [measure(child.pid) for child in children], time.monotonic()
            time.sleep(WATCHED)
            passed = time.monotonic() - begin
            ended = [child.log.read_text() for child in children if child.poll() is not None]
            self.assertEqual(ended, [], f"busy: {shares}")
            shares = [(child.program, round((measure(child.pid) - was) / passed, 3)) for child, was in zip(children, before)]
            if all(share <= most for _, share in shares):
                return
        self.fail(f"shares of a processor while there is nothing to do: {shares}")

    def nowhere(self):
        """Options for a master that is not there."""
        return ["--master", f"tcp://127.0.0.1:{free_port()}", "--keys", self.keys]

    def test_without_a_master(self):
        nowhere = self.nowhere()
        self.check(self.start("tessera-node", *nowhere, "--backend", "null"),
                   self.start("tessera", "render", SCENE, *nowhere, "-o", self.programs.scratch / "never.png"),
                   self.start("tessera", "watch", *nowhere, "-o", self.programs.scratch / "never.png"),
                   self.start("tessera-display", *nowhere, "--output", "left", "--headless"))

    def test_without_a_master_the_first_signal_ends_them(self):
        waiting = {self.start("tessera-node", *self.nowhere(), "--backend", "null"): 0,
                   self.start("tessera", "render", SCENE, *self.nowhere(), "-o", self.programs.scratch / "never.png"): 130,
                   self.start("tessera", "watch", *self.nowhere(), "-o", self.programs.scratch / "never.png"): 130,
                   self.start("tessera", "display", "track", *self.nowhere(), "--udp", "0"): 130,
                   self.start("tessera-display", *self.nowhere(), "--output", "left", "--headless"): 130}
        time.sleep(START)
        for child in waiting:
            child.send_signal(signal.SIGTERM)
        for child, status in waiting.items():
            self.assertEqual(child.wait(4), status, child.log.read_text())  # clients alone would wait for 10 s

    def test_the_first_signal_ends_clients_that_have_lost_their_master(self):
        cluster = self.cluster(0)
        clients = [self.start_client(cluster, "render", SCENE, "-o", self.programs.scratch / "never.png"),
                   self.start_client(cluster, "watch", "-o", self.programs.scratch / "never.png")]
        time.sleep(START)
        cluster.master.kill()
        time.sleep(START)
        for client in clients:
            client.send_signal(signal.SIGTERM)
        for client in clients:
            self.assertEqual(client.wait(8), 130, client.log.read_text())  # it would look for its master for 30 s

    def cluster(self, nodes):
        """Ends after the clients that were started later."""
        return self.enterContext(Cluster(self.programs, nodes, backend="null"))

    def start_client(self, cluster, command, *options):
        return self.start("tessera", command, *options, "--master", cluster.endpoint, "--keys", cluster.keys)

    def test_without_work(self):
        self.check(*self.cluster(1).children)

    def test_without_nodes(self):
        cluster = self.cluster(0)
        render = self.start_client(cluster, "render", SCENE, "-o", self.programs.scratch / "later.png")
        self.check(render, *cluster.children)

    def test_with_a_live_scene_whose_frame_is_complete(self):
        cluster = self.cluster(1)
        watch = self.start_client(cluster, "watch", "--size", "64x48", "--spp", "4", "-o", self.programs.scratch / "now.png")
        self.check(watch, *cluster.children)

    def test_while_workers_render(self):
        """Nodes hold film whose other half is being rendered."""
        cluster = self.cluster(0)
        for i in range(2):
            cluster.start_node(f"node-{i}", "--backend", "null", "--simulate-cost", "40us")
        cluster.wait_for(2)
        render = self.start_client(cluster, "render", SCENE, "--size", "256x256", "--spp", "64", "-o", self.programs.scratch / "slow.png")
        self.check(render, *cluster.children, most=2 * MOST, measure=loop_seconds)


if __name__ == "__main__":
    unittest.main()

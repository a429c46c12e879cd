#!/usr/bin/env python3
"""The package against the real master with keys. Usage: real_master_test.py BIN_FOLDER"""

import pathlib
import queue
import signal
import socket
import sys
import threading
import time
import unittest

import tessera
from real_cluster import RealCluster
from ports import free_port

PROGRAMS = pathlib.Path(sys.argv.pop()).resolve()


class Relay:
    """Passes TCP on to a master's two ports, with more delay to the master than back."""

    def __init__(self, master_port, delay):
        self.port, self.delay = free_port(), delay
        for link in range(2):
            listener = socket.create_server(("127.0.0.1", self.port + link))
            threading.Thread(target=self._serve, args=(listener, master_port + link), daemon=True).start()

    def _serve(self, listener, port):
        while True:
            near = listener.accept()[0]
            far = socket.create_connection(("127.0.0.1", port))
            for source, target, delay in ((near, far, self.delay), (far, near, 0.0)):
                source.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                waiting = queue.Queue()
                threading.Thread(target=self._read, args=(source, waiting, delay), daemon=True).start()
                threading.Thread(target=self._write, args=(target, waiting), daemon=True).start()

    @staticmethod
    def _read(source, waiting, delay):
        data = b"begin"
        while data:
            try:
                data = source.recv(65536)
            except OSError:
                data = b""
            waiting.put((time.monotonic() + delay, data))

    @staticmethod
    def _write(target, waiting):
        while True:
            due, data = waiting.get()
            time.sleep(max(0.0, due - time.monotonic()))
            if not data:
                return target.close()
            try:
                target.sendall(data)
            except OSError:
                return None


class RealMaster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = RealCluster(PROGRAMS)

    @classmethod
    def tearDownClass(cls):
        cls.cluster.close()

    def test_every_client_role_sees_the_status(self):
        for user in ("viewer", "editor", "operator"):
            with self.cluster.connect(user=user) as session:
                status = session.status()
                self.assertGreaterEqual(status.sessions, 1)
                self.assertGreater(status.uptime_seconds, 0)

    def test_clocks_agree_within_bounds_through_an_asymmetric_relay(self):
        relay = Relay(self.cluster.port, 0.02)
        self.cluster.start("tessera-node", "--master", self.cluster.endpoint, "--name", "near", "--backend", "null")
        self.cluster.start("tessera-node", "--master", f"tcp://127.0.0.1:{relay.port}", "--name", "far", "--backend", "null")
        with self.cluster.connect() as session:
            end = time.monotonic() + 60
            while True:
                nodes = {node.name: node for node in session.status().nodes if node.clock_bound_seconds > 0}
                if len(nodes) == 2:
                    break
                self.assertLess(time.monotonic(), end, "a node has no clock after a minute")
                time.sleep(0.1)
        for node in nodes.values():
            self.assertLessEqual(abs(node.clock_offset_seconds), node.clock_bound_seconds, node)
        self.assertGreaterEqual(nodes["far"].clock_bound_seconds, 0.01)

    def test_node_key_is_rejected(self):
        with self.assertRaisesRegex(tessera.Refused, "role"):
            self.cluster.connect(user="node")

    def test_keys_are_required(self):
        with self.assertRaises(tessera.Unavailable):
            tessera.connect(self.cluster.endpoint, connect_limit=1.0)

    def test_an_exported_key_is_one_file(self):
        export = self.cluster.folder / "anna.key"
        self.cluster.run("tessera", "keys", self.cluster.keys, "add", "anna", "--role", "editor", "--export", export)
        self.cluster.master.send_signal(signal.SIGHUP)  # SIGHUP: it reads the list again
        with self.cluster.connect(keys=export) as session:
            self.assertIn("tessera", session.status().software)


if __name__ == "__main__":
    unittest.main()

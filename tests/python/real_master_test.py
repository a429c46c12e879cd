#!/usr/bin/env python3
"""The package against the real master with keys. Usage: real_master_test.py BIN_FOLDER"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import tessera
from scripted_master import free_port

PROGRAMS = pathlib.Path(sys.argv.pop()).resolve()


class RealMaster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.keys = pathlib.Path(cls.folder.name) / "keys"
        subprocess.run([PROGRAMS / "tessera", "keys", cls.keys], check=True, stdout=subprocess.DEVNULL)
        cls.endpoint = f"tcp://127.0.0.1:{free_port()}"
        cls.log = open(pathlib.Path(cls.folder.name) / "master.log", "w+", encoding="utf-8")
        cls.children = []
        cls.start("tessera-master", "--listen", cls.endpoint, "--heartbeat", "0.25")

    @classmethod
    def start(cls, program, *arguments):
        cls.children.append(subprocess.Popen([PROGRAMS / program, "--keys", cls.keys, *arguments], stdout=cls.log,
                                             stderr=cls.log))

    @classmethod
    def tearDownClass(cls):
        for child in reversed(cls.children):
            child.terminate()
            child.wait(30)
        cls.log.close()
        cls.folder.cleanup()

    def connect(self, **more):
        return tessera.connect(self.endpoint, **{"keys": self.keys, **more})

    def test_every_client_role_sees_the_status(self):
        for user in ("viewer", "editor", "operator"):
            with self.connect(user=user) as session:
                status = session.status()
                self.assertGreaterEqual(status.sessions, 1)
                self.assertGreater(status.uptime_seconds, 0)

    def test_a_node_key_is_no_clients(self):
        with self.assertRaisesRegex(tessera.Refused, "role"):
            self.connect(user="node")

    def test_no_keys_are_no_way_in(self):
        with self.assertRaises(tessera.Unavailable):
            tessera.connect(self.endpoint, connect_limit=1.0)

    def test_an_exported_key_is_one_file(self):
        export = pathlib.Path(self.folder.name) / "anna.key"
        subprocess.run([PROGRAMS / "tessera", "keys", self.keys, "add", "anna", "--role", "editor", "--export", export],
                       check=True, stdout=subprocess.DEVNULL)
        self.children[0].send_signal(1)  # SIGHUP: it reads the list again
        with self.connect(keys=export) as session:
            self.assertIn("tessera", session.status().software)


if __name__ == "__main__":
    unittest.main()

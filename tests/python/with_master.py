"""A session with a master that the test plays, already in a scene."""

import unittest

import tessera
from scripted_master import ScriptedMaster


def connect(master, **more):
    return tessera.connect(master.endpoint, **{"name": "test", "connect_limit": 5.0, "lost_limit": 20.0, **more})


class WithMaster(unittest.TestCase):
    POSE = tessera.look_at((0, 1, 5), (0, 0, 0))

    def setUp(self):
        self.master = ScriptedMaster().start()
        self.addCleanup(self.master.stop)
        self.session = connect(self.master)
        self.addCleanup(self.session.close)
        self.scene = self.session.join("room")

    def create_red(self):
        with self.session.transaction() as edit:
            return edit.create("material", name="red", base_color=(1, 0, 0, 1))

    def wait_for(self, is_there):
        self.master.wait_for(is_there)

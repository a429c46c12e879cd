#!/usr/bin/env python3
"""Live scenes with the real master and a node that renders, over CURVE. Usage: live_master_test.py BIN_FOLDER"""

import math
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import run_block
import tessera
import tessera.records
from real_cluster import RealCluster

PROGRAMS = pathlib.Path(sys.argv.pop()).resolve()
POSE = tessera.look_at((0, 0, 3), (0, 0, 0))
VIEWER = """
import sys, tessera
with tessera.connect(sys.argv[1], keys=sys.argv[2], user="viewer", name="viewer") as session:
    session.join()
    view = session.open_view(tessera.look_at((0, 0, 3), (0, 0, 0)), size=(320, 180), spp=4, picture="planes")
    while True:
        frame = view.next_frame(60)
        print(frame.version[1], flush=True)
"""
WALL = dict(indices=[(0, 1, 2), (0, 2, 3)], positions=[(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)])


class LiveMaster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = RealCluster(PROGRAMS)
        cls.cluster.start("tessera-node", "--master", cls.cluster.endpoint, "--name", "n1", "--threads", "1")

    @classmethod
    def tearDownClass(cls):
        cls.cluster.close()

    def setUp(self):
        self.session = self.cluster.connect(name="anna")
        self.addCleanup(self.session.close)
        self.scene = self.session.join("room")
        self.addCleanup(self.close_scene)

    def close_scene(self):
        try:
            self.session.close_scene()
        except tessera.Error:  # of a test that lost it
            pass

    def emissive_wall(self, color=(1.0, 0.0, 0.0)):
        """An emissive wall in front of the camera: its pixels have its colour, without noise."""
        with self.session.transaction() as edit:
            self.emissive = edit.create("material", name="emissive", emission=color, base_color=(0, 0, 0, 1), double_sided=True)
            self.wall = edit.create("geometry", name="wall", material=self.emissive, **WALL)
        return self.session.open_view(POSE, size=(64, 48), spp=8, picture="planes", film=True)

    def center(self, frame):
        at = frame.height // 2 * frame.width + frame.width // 2
        return tuple(round(plane[at], 3) for plane in frame.planes())

    def test_render(self):
        self.emissive_wall(color=(0.25, 0.5, 0.75)).close()
        phases = []
        rendered = self.session.render(POSE, size=(64, 48), spp=8, picture="planes", film=True, filter="gauss",
                                       on_progress=lambda progress: phases.append(progress.phase))
        self.assertEqual(rendered.summary.outcome, "complete")
        self.assertEqual(rendered.summary.samples, 64 * 48 * 8)
        self.assertEqual(rendered.summary.nodes, ("n1",))
        self.assertTrue(rendered.summary.filter.startswith("gauss"))
        self.assertEqual([round(plane[64 * 24 + 32], 3) for plane in rendered.frame.planes()], [0.25, 0.5, 0.75])
        self.assertEqual(set(rendered.frame.film().counts), {8})
        self.assertLessEqual(set(phases), {"waiting_for_nodes", "syncing", "rendering", "filtering", "delivering"})
        flat = self.session.render(POSE, size=(64, 48), noise=0.01)
        self.assertEqual(flat.summary.samples, 64 * 48 * 16)  # what all pixels get before the first decision
        self.assertLess(flat.summary.noise, 0.01)
        for noise in (0.0, -1.0, 1.5, math.nan):
            with self.assertRaisesRegex(tessera.InvalidInput, "noise"):
                self.session.render(POSE, noise=noise)
            with self.assertRaisesRegex(tessera.InvalidInput, "error"):
                self.session.render(POSE, error=noise)
        late = self.session.render(POSE, size=(64, 48), spp=1 << 20, budget=0.5)
        self.assertEqual(late.summary.outcome, "time_up")
        with self.cluster.connect(name="bob") as bob, self.assertRaises(tessera.Refused):
            bob.join("another", exclusive=True, no_wait=True)

    def test_set_filter_of_a_named_view(self):
        view = self.emissive_wall()
        view.wait(samples=8)
        self.assertIn("gauss", self.session.set_filter("gauss", "anna/1"))
        with self.assertRaisesRegex(tessera.Refused, "no view named 'unknown/9'"):
            self.session.set_filter("gauss", "unknown/9")

    def test_the_picture_follows_edits_and_undo(self):
        view = self.emissive_wall()
        frame = view.wait(samples=8)
        while not frame.complete:  # all samples may be there a moment before the view has ended
            frame = view.next_frame(30)
        self.assertEqual(self.center(frame), (1.0, 0.0, 0.0))
        film = frame.film()
        self.assertEqual(set(film.counts), {8})
        self.assertAlmostEqual(film.planes("radiance")[0][24 * 64 + 32], 1.0, 5)
        with self.session.transaction() as edit:
            edit.set("materials/emissive", emission=(0, 1, 0))
        self.assertEqual(self.center(view.wait(samples=0)), (0.0, 1.0, 0.0))
        self.session.undo()
        self.assertEqual(self.center(view.wait(samples=8)), (1.0, 0.0, 0.0))
        self.session.redo()
        self.assertEqual(self.center(view.wait(samples=1)), (0.0, 1.0, 0.0))

    def test_frames_have_the_version_they_show(self):
        view = self.emissive_wall()
        for step in range(1, 101):
            with self.session.transaction() as edit:
                edit.set("materials/emissive", emission=(step, 0, 0))
            self.assertEqual(self.center(view.wait(samples=0))[0], step)
            if step % 10 == 0:
                self.assertEqual(self.center(view.wait(samples=8))[0], step)

    def test_wait_after_an_invisible_edit_returns(self):
        view = self.emissive_wall()
        view.wait(samples=8)
        with self.session.transaction() as edit:
            edit.set("materials/emissive", name="embers")
        self.assertEqual(self.center(view.wait(samples=8, timeout=30)), (1.0, 0.0, 0.0))

    def test_camera_and_picking(self):
        view = self.emissive_wall()
        view.wait(samples=1)  # what is picked is what is shown
        hit = view.pick(32, 24)
        self.assertEqual(hit.object, self.wall.id)
        self.assertAlmostEqual(hit.position[2], 0.0, 4)
        self.assertAlmostEqual(hit.normal[2], 1.0, 4)
        view.look(tessera.look_at((0, 0, -3), (0, 0, -9)))  # away from it
        self.assertEqual(self.center(view.wait(samples=1)), (0.0, 0.0, 0.0))
        self.assertIsNone(view.pick(32, 24))

    def test_files_of_every_kind(self):
        self.emissive_wall().close()
        with tempfile.TemporaryDirectory() as folder:
            for kind, magic in (("png", b"\x89PNG"), ("jpeg", b"\xff\xd8\xff"), ("exr", b"v/1\x01")):
                view = self.session.open_view(POSE, size=(64, 48), spp=4, picture=kind)
                path = pathlib.Path(folder) / f"wall.{kind}"
                view.wait(samples=4).save(path)
                self.assertEqual(path.read_bytes()[:len(magic)], magic)
                view.close()

    def test_two_editors(self):
        self.emissive_wall().close()
        with self.cluster.connect(name="anna") as other:
            theirs = other.join("elsewhere")
            self.assertEqual(theirs.title, "room")
            self.assertNotEqual(other.name, "anna")  # duplicate names are made unique
            self.assertEqual(theirs["geometries/wall"], self.scene["geometries/wall"])
            self.assertEqual(len(theirs.bytes_of(theirs.get(tessera.Geometry, "wall").positions)), 48)
            self.session.lock([self.emissive])
            with self.assertRaisesRegex(tessera.Refused, "anna"):
                with other.transaction() as edit:
                    edit.set("materials/emissive", roughness=0.5)
            self.session.unlock([self.emissive])
            with other.transaction() as edit:
                edit.set("materials/emissive", roughness=0.5)
            self.scene.refresh()
            self.assertEqual(self.scene.get(tessera.Material, "emissive").roughness, 0.5)
            self.assertEqual(self.session.writers(self.emissive)["roughness"].name, other.name)
            self.assertEqual(self.session.history(1)[0].name, other.name)
            other.set_presence("paints", [self.emissive])
            end = time.monotonic() + 30
            while not any(p.text == "paints" and p.selection == (self.emissive.id,) for p in self.session.members().members):
                self.assertLess(time.monotonic(), end)
                time.sleep(0.05)

    def test_rejected_edits_change_nothing(self):
        self.emissive_wall().close()
        before = list(self.scene)
        for change in (lambda edit: edit.remove("materials/emissive"), lambda edit: edit.set("materials/emissive", metallic=7.0),
                       lambda edit: edit.create("geometry", name="half", indices=[0, 1, 2])):
            with self.assertRaises(tessera.Refused) as caught:
                with self.session.transaction() as edit:
                    edit.create("light", name="unseen")
                    change(edit)
            self.assertTrue(caught.exception.problems)
        self.scene.refresh()
        self.assertEqual(list(self.scene), before)

    def test_viewers_cannot_edit(self):
        self.emissive_wall().close()
        with self.cluster.connect(user="viewer", name="guest") as guest:
            scene = guest.join()
            self.assertNotIn("geometries/wall", scene, "viewers read cameras only")
            view = guest.open_view(POSE, size=(32, 24), spp=1, picture="planes")
            self.assertEqual(round(view.wait(samples=1).planes()[0][0], 3), 1.0)
            with self.assertRaisesRegex(tessera.Refused, "role"):
                guest.undo()

    def test_view_of_another_member(self):
        view = self.session.open_view(POSE, size=(64, 48), spp=4, name="main")
        view.wait(samples=4)
        with self.cluster.connect(user="viewer") as guest:
            guest.join()
            self.assertEqual(guest.watch("main").wait(samples=4).width, 64)

    def test_a_drag_is_one_undo(self):
        self.emissive_wall((0.0, 0.0, 0.0)).close()
        drag = self.session.new_edit_group()
        for step in range(1, 20):
            with self.session.transaction(edit_group=drag) as edit:
                edit.set("materials/emissive", emission=(step, 0, 0))
        self.session.undo()
        self.assertEqual(self.scene.get(tessera.Material, "emissive").emission, (0.0, 0.0, 0.0))

    def test_large_scene_round_trip(self):
        with self.session.transaction() as edit:
            for i in range(3000):
                edit.create("material", name=f"m{i}", roughness=0.5)
            edit.create("geometry", name="big", indices=[0, 1, 2], positions=bytes(12) * 300_000)
        with self.cluster.connect(name="bert") as other:
            scene = other.join()
            self.assertEqual(len(scene.all(tessera.Material)), 3000)
            big = scene.get(tessera.Geometry, "big")
            self.assertEqual(scene.bytes_of(big.positions), bytes(12) * 300_000)

    def test_rejoin_after_a_timeout_restores_state(self):
        view = self.emissive_wall()
        view.wait(samples=8)
        self.session.lock([self.emissive])
        self.cluster.master.send_signal(signal.SIGSTOP)
        time.sleep(2.0)  # both sides take the other for gone
        self.cluster.master.send_signal(signal.SIGCONT)
        with self.session.transaction() as edit:
            edit.set("materials/emissive", emission=(0, 0, 1))
        self.assertEqual(self.center(view.wait(samples=8)), (0.0, 0.0, 1.0))
        self.assertEqual(self.session.members().locks, (tessera.records.Lock(self.emissive.id, "anna"),))
        self.session.undo()
        self.assertEqual(self.scene.get(tessera.Material, "emissive").emission, (1.0, 0.0, 0.0))
        with self.session.transaction() as edit:
            self.assertNotIn(edit.create("light").id, (self.emissive.id, self.wall.id))

    def test_stalled_viewer_delays_no_other_and_resumes_with_the_newest(self):
        view = self.emissive_wall()
        viewer = subprocess.Popen([sys.executable, "-c", VIEWER, self.cluster.endpoint, self.cluster.keys],
                                  stdout=subprocess.PIPE, text=True)
        try:
            viewer.stdout.readline()
            viewer.send_signal(signal.SIGSTOP)
            for step in range(1, 301):
                with self.session.transaction() as edit:
                    edit.set(self.emissive, emission=(step, 0, 0))
                if step % 100 == 0:
                    self.assertEqual(self.center(view.wait(samples=8))[0], step)
            time.sleep(1.5)  # the master takes it for gone
            viewer.send_signal(signal.SIGCONT)
            last = edit.committed.version[1]
            seen = 0
            frames = 0
            while seen < last:
                line = viewer.stdout.readline()
                self.assertTrue(line, "the viewer ended")
                seen, frames = int(line), frames + 1
            self.assertLess(frames, 50)  # not one for each edit
        finally:
            viewer.kill()
            viewer.wait()
            viewer.stdout.close()

    def test_master_that_lost_the_scene_is_an_error(self):
        self.emissive_wall()
        self.cluster.kill_master_and_start_another()
        with self.assertRaisesRegex(tessera.Unavailable, "lost edits"):
            with self.session.transaction() as edit:
                edit.set(self.emissive, roughness=0.5)
        self.session = self.cluster.connect(name="anna")
        self.addCleanup(self.session.close)
        self.scene = self.session.join("room")
        self.addCleanup(self.close_scene)
        self.assertEqual(self.center(self.emissive_wall().wait(samples=8)), (1.0, 0.0, 0.0))  # the node is back, too

    def test_a_display_is_adjusted_and_its_head_moved(self):
        with self.assertRaisesRegex(tessera.Refused, "no display is open"):
            self.session.adjust_display(exposure=1.0)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "wall.toml"
            file.write_text("[[output]]\nname = 'desk'\nsize = [64, 48]\n")
            self.cluster.run("tessera", "display", "open", file, "--master", self.cluster.endpoint, "--keys",
                             self.cluster.keys)
        for x in range(100):
            self.session.move_head((0.01 * x, 0, 0), (1, 0, 0, 0))
        self.session.adjust_display(eye_separation=0.06, zero_parallax=2.0, exposure=1.0, pattern=True)
        for change, reason in ((dict(eye_separation=-1), "eye separation"), (dict(exposure=100), "exposure"),
                               (dict(shown_layers=[0]), "no layers to choose from")):
            with self.assertRaisesRegex(tessera.Refused, reason):
                self.session.adjust_display(**change)
        with self.cluster.connect(user="viewer", name="guest") as guest:
            guest.join()
            with self.assertRaisesRegex(tessera.Refused, "role"):
                guest.adjust_display(pattern=False)

    def test_the_example_of_the_readme(self):
        readme = pathlib.Path(__file__).resolve().parents[2] / "README.md"
        with tempfile.TemporaryDirectory() as folder:
            run_block.run(readme, self.cluster.endpoint, str(self.cluster.keys), folder, ["room.png"])
        self.scene.refresh()
        self.assertIn("geometries/tile", self.scene)


if __name__ == "__main__":
    unittest.main()

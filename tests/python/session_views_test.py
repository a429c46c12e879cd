#!/usr/bin/env python3
"""Views of a session against a scripted master: cameras, layers, picking, stops and frames that cannot be."""

import logging
import math
import pathlib
import tempfile
import time
import unittest

import tessera
from scripted_master import PNG
from tessera import bulk
from tessera.proto import common_pb2, view_pb2
from with_master import WithMaster

logging.disable(logging.CRITICAL)


class Views(WithMaster):
    def test_frames_come_one_at_a_time_and_the_newest_is_taken(self):
        view = self.session.open_view(self.POSE, size=(8, 4), spp=64)
        time.sleep(0.3)  # no client waits: one frame is buffered, none follows
        self.assertEqual(self.master.members[1].frame[1], 1)
        frame = view.wait(samples=16)
        self.assertEqual((frame.min_samples, frame.width, frame.height, frame.data), (16, 8, 4, PNG))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "room.png"
            frame.save(path)
            self.assertEqual(path.read_bytes(), PNG)
            with self.assertRaisesRegex(tessera.InvalidInput, "png"):
                frame.save(path.with_suffix(".jpg"))
        self.assertTrue(view.wait(samples=1000).complete)
        with self.assertRaisesRegex(tessera.Unavailable, "after 0.1 s"):
            view.wait(samples=1, timeout=0.1)

    def test_a_frame_that_a_rejoin_cuts_off_is_acknowledged(self):
        """Else the master, which sends one frame at a time, would send no other."""
        view = self.session.open_view(self.POSE, size=(8, 4), spp=64)
        view.wait(samples=1)
        with self.session.connection.changed:
            view.began(bulk.FrameHeader(view.number, 99, 1, 1, 1, 1, 8, 4, 3, 2, 100, 0, 0, 0, 0, 0, 0, 1, 1, 64, bytes(32)),
                       time.monotonic())
            view.reopened()
        deadline = time.monotonic() + 10
        while self.master.members[1].taken.get(view.number) != 99 and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertEqual(self.master.members[1].taken[view.number], 99)

    def test_planes_and_film(self):
        view = self.session.open_view(self.POSE, size=(4, 2), spp=4, picture="planes", film=True,
                                      channels=("radiance", "depth"))
        frame = view.wait(samples=4)
        self.assertEqual([list(p) for p in frame.planes()], [list(range(8 * i, 8 * i + 8)) for i in range(3)])
        film = frame.film()
        self.assertEqual(film.channels, ("radiance", "depth"))
        self.assertEqual(list(film.counts), [4] * 8)
        self.assertEqual([len(p) for p in film.planes("radiance")], [8] * 6)
        self.assertEqual([len(p) for p in film.planes("depth")], [8])
        with self.assertRaises(tessera.InvalidInput):
            film.planes("albedo")

    def test_wait_includes_edits_of_this_session(self):
        view = self.session.open_view(self.POSE, size=(8, 4), spp=1 << 40)
        before = view.wait(samples=1)
        self.create_red()
        after = view.wait(samples=1)
        self.assertGreater(after.version, before.version)
        view.look(tessera.look_at((1, 1, 5), (0, 0, 0)))
        self.assertGreater(view.wait(samples=1).revision, after.revision)
        other = self.session.open_view(self.POSE, size=(8, 4), spp=1 << 40)
        other.change(spp=1 << 41)
        other.look(tessera.look_at((1, 1, 5), (0, 0, 0)))  # before the first frame was looked at
        self.assertEqual(other.wait(samples=1).revision, 3)
        with self.assertRaisesRegex(tessera.Refused, "needs samples"):
            other.change(spp=0)
        self.assertEqual(other.wait(samples=1).revision, 3)  # as it was

    def test_pictures_for_the_eye_are_denoised(self):
        def filter_of(**arguments):
            view = self.session.open_view(self.POSE, size=(8, 4), **arguments)
            wanted = self.master.views[max(self.master.views)][0].wanted
            view.close()
            return wanted.view.filter
        self.assertEqual(filter_of(), b"psvgf")
        self.assertEqual(filter_of(picture="jpeg"), b"psvgf")
        self.assertEqual(filter_of(filter="none"), b"none")
        self.assertEqual(filter_of(filter=""), b"")
        self.assertEqual(filter_of(picture="planes"), b"")
        self.assertEqual(filter_of(film=True), b"")
        self.assertEqual(filter_of(picture="planes", filter="nfor"), b"nfor")

    def test_the_camera_of_the_scene(self):
        with self.session.transaction() as edit:
            camera = edit.create("camera", name="main", vertical_fov=1.0)
            edit.create("transform", name="stand", matrix=tessera.translation(1, 2, 3), children=[camera])
        self.assertNotIn(camera.id, self.scene.root.children)  # it has its place already
        self.session.open_view("cameras/main", size=(200, 100))
        view = self.master.views[1][0].wanted.view
        self.assertEqual(list(view.world_from_camera)[12:15], [1, 2, 3])
        self.assertAlmostEqual(view.frustum[1], 2 * view.frustum[3])
        with self.assertRaisesRegex(tessera.InvalidInput, "is not a camera"):
            self.session.open_view("transforms/stand")

    def test_thin_lens_and_orthographic_cameras(self):
        self.session.open_view(tessera.look_at((0, 0, 5), (0, 0, 0), lens_radius=0.02, focus_distance=4.5,
                                               aperture="gaussian"), size=(200, 100))
        view = self.master.views[1][0].wanted.view
        self.assertEqual((view.projection, view.lens_radius, view.focus_distance, view.aperture), (0, 0.02, 4.5, 1))
        self.assertAlmostEqual(view.frustum[3], math.tan(0.35))
        with self.session.transaction() as edit:
            camera = edit.create("camera", name="plan", projection="orthographic", orthographic_height=6.0,
                                 lens_radius=0.5, focus_distance=3.0)
            edit.create("transform", name="above", matrix=tessera.translation(0, 0, 9), children=[camera])
        opened = self.session.open_view("cameras/plan", size=(200, 100))
        view = self.master.views[2][0].wanted.view
        self.assertEqual((view.projection, view.lens_radius, view.focus_distance, view.aperture), (1, 0.5, 3.0, 0))
        self.assertEqual(list(view.frustum), [-6, 6, -3, 3])
        opened.look(tessera.look_at((0, 0, 5), (0, 0, 0)))  # a pinhole again
        view = self.master.views[2][0].wanted.view
        self.assertEqual((view.projection, view.lens_radius), (0, 0))
        for wrong in ({"projection": "fish-eye"}, {"aperture": "square"}, {"lens_radius": -1}, {"focus_distance": 0},
                      {"orthographic_height": 0}, {"vertical_fov": 4}):
            with self.assertRaises(tessera.InvalidInput, msg=str(wrong)):
                tessera.look_at((0, 0, 5), (0, 0, 0), **wrong)

    def test_camera_motion_blur(self):
        a, b, c = (tessera.look_at((x, 0, 5), (0, 0, 0)) for x in (0, 1, 2))
        opened = self.session.open_view(a.moving_to(b, c), size=(8, 4))
        view = self.master.views[1][0].wanted.view
        self.assertEqual(tuple(view.world_from_camera), a.world_from_camera)
        self.assertEqual(tuple(view.camera_motion), b.world_from_camera + c.world_from_camera)
        opened.look(b)  # without motion
        self.assertEqual(len(self.master.views[1][0].wanted.view.camera_motion), 0)
        with self.assertRaisesRegex(tessera.InvalidInput, "16 keys: at most 15"):
            a.moving_to(*[b] * 16)
        with self.assertRaisesRegex(tessera.InvalidInput, "16 finite numbers"):
            tessera.Pose((1.0, 2.0))
        with self.session.transaction() as edit:
            camera = edit.create("camera", name="main")
            lift = edit.create("transform", name="lift", children=[camera],
                               matrix=tessera.translation(0, 1, 0), motion=[tessera.translation(0, 2, 0)])
        opened = self.session.open_view("cameras/main", size=(8, 4))
        view = self.master.views[opened.number][0].wanted.view
        self.assertEqual([list(view.world_from_camera)[12:15], list(view.camera_motion)[12:15]], [[0, 1, 0], [0, 2, 0]])
        # Two that move: as many steps as there may be, 2 x 7, and scale is taken out.
        big = (2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0)
        with self.session.transaction() as edit:
            edit.create("transform", name="cart", children=[lift], matrix=(*big, 0.0, 0.0, 0.0, 1.0),
                        motion=[(*big, 7.0, 0.0, 0.0, 1.0), (*big, 0.0, 0.0, 7.0, 1.0)])
            edit.detach(lift, "root")
        opened.look("cameras/main")
        motion = list(self.master.views[opened.number][0].wanted.view.camera_motion)
        self.assertEqual(len(motion), 16 * 14)
        for step in range(1, 15):
            matrix = motion[16 * step - 16:16 * step]
            x, z = (step, 0) if step <= 7 else (14 - step, step - 7)
            for value, expected in zip(matrix[12:15], (x, 2 * (1 + step / 14), z)):
                self.assertAlmostEqual(value, expected, 12)
            self.assertEqual(matrix[:12], list(tessera.translation(0, 0, 0))[:12])

    def test_layers(self):
        with self.session.transaction() as edit:
            edit.create("transform", name="gui", layers=5)
        self.assertEqual(self.scene["transforms/gui"].layers, 5)
        self.session.open_view(self.POSE, size=(8, 4))
        self.assertEqual(self.master.views[1][0].wanted.view.hidden_layers, 0)
        self.session.open_view(self.POSE, size=(8, 4), layers=5)
        self.assertEqual(self.master.views[2][0].wanted.view.hidden_layers, 0xFFFFFFFA)
        with self.assertRaisesRegex(tessera.InvalidInput, "32 bits"):
            self.session.open_view(self.POSE, layers=1 << 32)

    def test_sky_sampling(self):
        self.session.open_view(self.POSE, size=(100, 100))
        self.assertEqual(self.master.views[1][0].wanted.view.sky_cells_from, 27)
        self.session.open_view(self.POSE, size=(8, 4), sky_sampling="luminance")
        self.assertFalse(self.master.views[2][0].wanted.view.HasField("sky_cells_from"))
        with self.assertRaisesRegex(tessera.InvalidInput, "visible, luminance"):
            self.session.open_view(self.POSE, sky_sampling="blue")

    def test_clamp(self):
        self.session.open_view(self.POSE, size=(8, 4))
        self.assertEqual(self.master.views[1][0].wanted.view.clamp_indirect, 0.0)
        self.session.open_view(self.POSE, size=(8, 4), clamp=2.5)
        self.assertEqual(self.master.views[2][0].wanted.view.clamp_indirect, 2.5)
        for clamp in (0.0, -1.0, math.inf, math.nan):
            with self.subTest(clamp=clamp), self.assertRaisesRegex(tessera.InvalidInput, "above 0"):
                self.session.open_view(self.POSE, clamp=clamp)

    def test_picking(self):
        view = self.session.open_view(self.POSE, size=(8, 4))
        self.assertIsNone(view.pick(0, 0))
        self.assertEqual(view.pick(2, 0), tessera.Hit(65536, (1.0, 2.0, 3.0), (0.0, 1.0, 0.0), 4.0))
        with self.assertRaisesRegex(tessera.Refused, "the node is gone"):
            view.pick(1, 0)
        with self.assertRaisesRegex(tessera.InvalidInput, "outside"):
            view.pick(8, 0)
        view.close()
        with self.assertRaisesRegex(tessera.InvalidInput, "closed"):
            view.pick(2, 0)

    def test_render(self):
        heard = []
        rendered = self.session.render(self.POSE, size=(8, 4), spp=16, film=True, budget=2.5, on_progress=heard.append)
        self.assertEqual(rendered.frame.min_samples, 16)
        self.assertEqual(len(rendered.frame.film().counts), 32)
        self.assertEqual((rendered.summary.outcome, rendered.summary.rays, rendered.summary.nodes), ("complete", 7, ("n1",)))
        self.assertEqual([(p.phase, p.seconds) for p in heard], [("rendering", 1.5)])
        self.wait_for(lambda: self.master.received.count("end_view") == 1)
        self.assertEqual(self.master.views, {})
        with self.assertRaisesRegex(tessera.Refused, "needs samples"):
            self.session.render(self.POSE, spp=0)

    def test_tiles_that_no_node_could_render_are_in_the_summary(self):
        self.master.failed_tiles = [
            view_pb2.FailedTile(rect=common_pb2.Rect(x=4, y=0, width=4, height=2), samples=3, message=b"a bad shader")]
        summary = self.session.render(self.POSE, size=(8, 4), spp=16).summary
        self.assertEqual(summary.outcome, "incomplete")
        self.assertEqual(summary.failed_tiles, (tessera.FailedTile(4, 0, 4, 2, 3, "a bad shader"),))

    def test_stopped_view_delivers_its_samples(self):
        view = self.session.open_view(self.POSE, size=(8, 4), spp=1 << 40)
        self.assertEqual(view.wait(samples=1).min_samples, 1)
        view.stop()
        end = view.wait_for_end(timeout=10.0)
        self.assertEqual((end.summary.outcome, end.frame.min_samples), ("stopped", 3))

    def test_exposure_and_view_transform(self):
        def wanted(view):
            return view._request.wanted.display_transform

        self.assertFalse(wanted(self.session.open_view(self.POSE, size=(8, 4))).HasField("exposure"))
        chosen = wanted(self.session.open_view(self.POSE, size=(8, 4), exposure=-1.5, view_transform="agx"))
        self.assertEqual((chosen.exposure, chosen.view_transform), (-1.5, 1))
        with self.assertRaisesRegex(tessera.InvalidInput, "no view transform 'filmic': choose of neutral, agx"):
            self.session.open_view(self.POSE, size=(8, 4), view_transform="filmic")

    def test_a_refused_view(self):
        with self.assertRaisesRegex(tessera.Refused, "needs samples"):
            self.session.open_view(self.POSE, spp=0)

    def test_malformed_frame_is_skipped(self):
        self.master.withholds_frames = True
        view = self.session.open_view(self.POSE, size=(8, 4), spp=1 << 40)
        self.assertIsNotNone(view.next_frame(5.0))
        member = self.master.members[1]
        for lie in (dict(width=9), dict(picture_bytes=1 << 40), dict(picture_bytes=7), dict(film_tiles=33)):
            frame = member.frame[1] + 1
            self.master.post(lambda lie=lie: self.master.send_frame(member, 1, 2, **lie))
            self.wait_for(lambda: member.taken.get(1) == frame)
        self.master.post(lambda: self.master.send_frame(member, 1, 2))
        self.assertEqual(view.next_frame(5.0).min_samples, 2)


if __name__ == "__main__":
    unittest.main()

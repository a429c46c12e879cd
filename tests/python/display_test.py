#!/usr/bin/env python3
"""What a session says about the display: heads and adjustments, to a scripted master."""

import logging
import math
import random
import threading
import time
import unittest

import tessera
from scripted_master import ScriptedMaster

logging.disable(logging.CRITICAL)


class Display(unittest.TestCase):
    def setUp(self):
        self.master = ScriptedMaster().start()
        self.addCleanup(self.master.stop)
        self.session = tessera.connect(self.master.endpoint, name="test", connect_limit=5.0, lost_limit=20.0)
        self.addCleanup(self.session.close)

    def moved(self, *where):
        count = len(self.master.heads)
        self.session.move_head(*where)
        # Earlier heads of another thread may still be on their way: wait for this one.
        position = [float(value) for value in where[0]]
        self.master.wait_for(lambda: len(self.master.heads) > count and
                             list(self.master.heads[-1].position) == position)
        return self.master.heads[-1]

    def test_head_is_sent_unchanged(self):
        self.session.join("room")
        head = self.moved((0.25, 1.75, -0.5))
        self.assertEqual((list(head.position), list(head.orientation)), ([0.25, 1.75, -0.5], [1, 0, 0, 0]))
        self.assertEqual(list(self.moved([0, 0, 0], (0, 0, 2, 0)).orientation), [0, 0, 1, 0])

    def test_orientations_are_normalized(self):
        self.session.join("room")
        random.seed(4)
        for length in (1e-320, 1e-200, 1e-3, 1.0, 1e200, 1e308):
            turn = [length * random.uniform(0.5, 1.0) for _ in range(4)]
            turned = self.moved((0, 0, 0), turn).orientation
            self.assertAlmostEqual(math.hypot(*turned), 1.0, 14)
            self.assertAlmostEqual(turned[1] * turn[0], turned[0] * turn[1], delta=1e-9 * length)

    def test_invalid_heads_are_not_sent(self):
        with self.assertRaisesRegex(tessera.InvalidInput, "join"):
            self.session.move_head((0, 0, 0))
        self.session.join("room")
        for position, turn in (((0, 0), (1, 0, 0, 0)), ((0, 0, math.nan), (1, 0, 0, 0)), ((0, 0, 0), (1, 0, 0)),
                               ((0, math.inf, 0), (1, 0, 0, 0)), ((0, 0, 0), (0, 0, 0, 0)),
                               ((0, 0, 0), (1, 0, 0, math.nan))):
            with self.assertRaisesRegex(tessera.InvalidInput, "position|orientation"):
                self.session.move_head(position, turn)
        self.moved((1, 2, 3))
        self.assertEqual(len(self.master.heads), 1)

    def test_only_given_settings_are_adjusted(self):
        self.session.join("room")
        self.session.adjust_display(exposure=-1.5)
        self.session.adjust_display(eye_separation=0.0, zero_parallax=2.0, pattern=False, shown_layers=())
        self.session.adjust_display(pattern=True, shown_layers=[0, 3])
        names = [[field.name for field, _ in change.ListFields() if field.name != "request"]
                 for change in self.master.adjustments]
        self.assertEqual(names, [["exposure"], ["eye_separation", "zero_parallax", "pattern", "shown_layers"],
                                 ["pattern", "shown_layers"]])
        self.assertEqual([change.shown_layers for change in self.master.adjustments], [0, 0, 9])
        self.assertEqual(self.master.adjustments[0].exposure, -1.5)

    def test_invalid_adjustments(self):
        self.session.join("room")
        for change in (dict(shown_layers=[4]), dict(shown_layers=[-1]), dict(exposure=math.nan)):
            with self.assertRaises(tessera.InvalidInput):
                self.session.adjust_display(**change)
        self.assertEqual(self.master.adjustments, [])
        with self.assertRaisesRegex(tessera.Refused, "not within 0 and 10 m"):
            self.session.adjust_display(eye_separation=11.0)

    def test_heads_continue_after_a_master_restart(self):
        self.session.join("room")
        stop = threading.Event()

        def track():
            while not stop.is_set():
                self.session.move_head((0, 0, 0))
                time.sleep(0.0002)

        tracker = threading.Thread(target=track)
        tracker.start()
        try:
            for _ in range(20):
                joins = self.master.received.count("join_scene")
                self.master.forget_sessions()
                self.master.wait_for(lambda: self.master.received.count("join_scene") > joins)
                self.session.members()  # raises when the session was lost
        finally:
            stop.set()
            tracker.join()
        self.moved((1, 0, 0))  # raises when it does not arrive


if __name__ == "__main__":
    unittest.main()

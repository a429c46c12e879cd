#!/usr/bin/env python3
"""Names of version 0.1 work, with a DeprecationWarning."""

import logging
import unittest

import tessera
from with_master import WithMaster

logging.disable(logging.CRITICAL)


class OldNames(WithMaster):
    def test_members(self):
        with self.assertWarnsRegex(DeprecationWarning, "'people' is now 'members'"):
            members = self.session.people()
        with self.assertWarnsRegex(DeprecationWarning, "'people' is now 'members'"):
            self.assertEqual([p.name for p in members.people], ["test"])
        with self.assertWarns(DeprecationWarning):
            self.assertIs(tessera.People, tessera.Members)
        with self.assertWarns(DeprecationWarning):
            self.assertIs(tessera.Person, tessera.Member)
        with self.assertRaises(AttributeError):
            tessera.Nothing  # pylint: disable=pointless-statement

    def test_edit_groups(self):
        with self.assertWarnsRegex(DeprecationWarning, "'gesture' is now 'new_edit_group'"):
            drag = self.session.gesture()
        with self.assertWarnsRegex(DeprecationWarning, "'gesture' is now 'edit_group'"):
            with self.session.transaction(gesture=drag) as edit:
                edit.create("material", name="red")
        with self.assertRaisesRegex(tessera.InvalidInput, "no argument 'gestur'"):
            self.session.transaction(gestur=drag)

    def test_sample_counts(self):
        frame = self.session.open_view(self.POSE, size=(8, 4), spp=16).wait(samples=1)
        with self.assertWarnsRegex(DeprecationWarning, "'samples_least' is now 'min_samples'"):
            self.assertEqual(frame.samples_least, frame.min_samples)
        with self.assertWarnsRegex(DeprecationWarning, "'samples_most' is now 'max_samples'"):
            self.assertEqual(frame.samples_most, frame.max_samples)


if __name__ == "__main__":
    unittest.main()

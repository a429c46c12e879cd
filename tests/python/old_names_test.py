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


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""check_words.py finds words wherever they are, and nothing else."""

import pathlib
import subprocess
import tempfile
import unittest

import check_words


class Words(unittest.TestCase):
    def violations(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            for name, text in files.items():
                (root / name).write_text(text)
            subprocess.run(["git", "-C", folder, "init", "-q"], check=True)
            subprocess.run(["git", "-C", folder, "add", "."], check=True)
            return list(check_words.check(root))

    def test_whole_words_and_parts_of_names_are_found(self):
        self.assertEqual(
            self.violations({"a.cpp": "int x;\n// Whoever comes.\nint glow_color, GlowColor, GLOW;\n"}),
            ["a.cpp:2: 'Whoever': write each user who, the caller", "a.cpp:3: 'glow': write emission",
             "a.cpp:3: 'Glow': write emission", "a.cpp:3: 'GLOW': write emission"])

    def test_other_words_are_not(self):
        self.assertEqual(self.violations({"a.md": "Glowworms, legal, tolder, the legend, a wishlist.\n"}), [])

    def test_names_of_files_are_checked(self):
        self.assertEqual(self.violations({"story.h": "\n"}), ["story.h:1: 'story': write path log"])

    def test_changes_and_binaries_are_not(self):
        self.assertEqual(self.violations({"CHANGELOG.md": "glow\n", "a.png": "glow\n"}), [])


if __name__ == "__main__":
    unittest.main()

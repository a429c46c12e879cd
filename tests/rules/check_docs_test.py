#!/usr/bin/env python3
"""Every rule of check_docs.py finds what it is there for, and nothing else."""

import pathlib
import tempfile
import unittest

import check_docs


class Documents(unittest.TestCase):
    def violations(self, readme, **pages):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            (root / "docs").mkdir()
            (root / "README.md").write_text(readme)
            for name, text in pages.items():
                (root / "docs" / f"{name}.md").write_text(text)
            return check_docs.check(root)

    def test_what_is_right_passes(self):
        readme = "# A\n\n[b](docs/b.md), [its part](docs/b.md#two-words), [web](https://example.org)\n"
        self.assertEqual(self.violations(readme, b="# B\n\n## Two `words`\n\n```\n[no](link.md)\n```\n[up](../README.md#a)\n"), [])

    def test_links_lead_somewhere(self):
        self.assertEqual(self.violations("[b](docs/b.md)\n", b="[c](c.md) [d](../README.md#d)\n"),
                         ["docs/b.md: there is no 'c.md'", "docs/b.md: '../README.md#d' names no heading"])

    def test_the_first_page_is_one(self):
        self.assertEqual(self.violations("a\n" * 121), ["README.md: 121 lines, more than 120"])
        self.assertEqual(self.violations("a" * 121 + "\n"), ["README.md:1: 121 characters, more than 120"])

    def test_every_page_is_in_the_index(self):
        self.assertEqual(self.violations("a\n", b="b\n"), ["README.md: its index lacks docs/b.md"])


if __name__ == "__main__":
    unittest.main()

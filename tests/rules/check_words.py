#!/usr/bin/env python3
"""Checks that names and texts of the whole tree use the field's words: none of those below, which once had other meanings here.

Usage: check_words.py ROOT. Prints one line per violation and exits 1 if there is any.

A word is found as a whole word and as a part of a name: 'glow' in 'glow_color' and 'GlowColor', not in 'glowworm'.
"""

import pathlib
import re
import subprocess
import sys

# Word -> what to write.
WORDS = {
    "aside": "equiangular sample, skip, save",
    "anybody": "any client, any node",
    "audience": "viewer preview",
    "bend": "deform, skin, morph",
    "bending": "deformation",
    "bends": "deforms",
    "bent": "deformed, curved",
    "beside": "next to, in addition to",
    "besides": "in addition to, also",
    "bury": "remove",
    "complain": "report_error",
    "contender": "benchmark target",
    "contenders": "benchmark targets",
    "everybody": "all clients, all nodes",
    "forth": "apply",
    "gesture": "edit group",
    "glow": "emission",
    "glowing": "emissive",
    "glows": "is emissive",
    "hostile": "malformed",
    "leg": "path segment",
    "legs": "path segments",
    "lend": "allocate",
    "lends": "allocates",
    "lent": "allocated",
    "likeness": "similarity",
    "nobody": "no client, no node",
    "people": "members, users",
    "rehearsal": "dry run",
    "rehearse": "calibrate, dry-run",
    "seldom": "rare",
    "shower": "output client",
    "showers": "output clients",
    "somebody": "another client, a user",
    "story": "path log",
    "tame": "compress",
    "teller": "path logger",
    "tells": "says, reports",
    "thrower": "projector",
    "throwers": "projectors",
    "told": "notified, reported, logged",
    "verdict": "check result",
    "whoever": "each user who, the caller",
    "whom": "recipient",
    "wish": "request",
    "worth": "equivalent spp",
}

# The changelog keeps the names of its time. The others are this list, and the tables of old names with their tests.
EXCEPT = {"CHANGELOG.md", "LICENSE", "check_words.py", "check_words_test.py", "old_names.h", "old_names.py", "old_names_test.cpp",
          "old_names_test.py"}
BINARY = {".png", ".glb", ".exr", ".bin", ".jpg", ".tessera"}

PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def violations_in(name, text):
    for number, line in enumerate(text.split("\n"), 1):
        for match in PART.finditer(line):
            instead = WORDS.get(match.group().lower())
            if instead:
                yield f"{name}:{number}: '{match.group()}': write {instead}"


def check(root):
    listed = subprocess.run(["git", "-C", str(root), "ls-files"], capture_output=True, text=True, check=True).stdout
    for name in listed.split("\n")[:-1]:
        path = root / name
        if path.name in EXCEPT or path.suffix in BINARY or not path.is_file():
            continue
        yield from violations_in(name, name)
        try:
            yield from violations_in(name, path.read_text())
        except UnicodeDecodeError:
            continue


def main():
    found = list(check(pathlib.Path(sys.argv[1]).resolve()))
    print("\n".join([*found, f"{len(found)} violations"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

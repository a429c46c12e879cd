#!/usr/bin/env python3
"""The Python example of the README against a scripted master. Usage: readme_block_test.py SOURCE_FOLDER"""

import pathlib
import sys
import tempfile

import run_block
from scripted_master import PNG, ScriptedMaster


def main():
    readme = pathlib.Path(sys.argv[1]).resolve() / "README.md"
    with ScriptedMaster() as master, tempfile.TemporaryDirectory() as folder:
        run_block.run(readme, master.endpoint, "-", folder, ["room.png"])
        assert (pathlib.Path(folder) / "room.png").read_bytes() == PNG
        assert len(master.objects) == 4, "the example no longer creates three objects in addition to the root"


main()

#!/usr/bin/env python3
"""The example of the package's README against a scripted master. Usage: readme_block_test.py SOURCE_FOLDER"""

import pathlib
import subprocess
import sys
import tempfile

from scripted_master import PNG, ScriptedMaster

HERE = pathlib.Path(__file__).resolve().parent


def main():
    readme = pathlib.Path(sys.argv[1]).resolve() / "client/python/README.md"
    with ScriptedMaster() as master, tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, str(HERE / "run_block.py"), str(readme), master.endpoint, "-", "room.png"],
                       cwd=folder, check=True, timeout=60)
        assert (pathlib.Path(folder) / "room.png").read_bytes() == PNG
        assert len(master.objects) == 4, "the example no longer creates three objects beside the root"


main()

"""Runs the first ```python block of a document as it is, except for the address and the keys.

Usage: run_block.py FILE ENDPOINT KEYS|- FOLDER [EXPECTED_OUTPUT_FILE...]   (- = without keys; runs in FOLDER)
"""

import pathlib
import re
import subprocess
import sys


def first_block(text):
    found = re.search(r"^```python\n(.*?)^```", text, re.S | re.M)
    if found is None:
        raise AssertionError("the document shows no Python any more")
    return found[1]


def run(document, where, keys, folder, expected):
    """Raises AssertionError where the example fails or a file that it should write is not there."""
    code = first_block(pathlib.Path(document).read_text())
    for shown, real in (('"tcp://127.0.0.1:7420"', repr(where)), ('"~/.tessera"', "None" if keys == "-" else repr(keys))):
        if shown not in code:
            raise AssertionError(f"the example no longer shows {shown}")
        code = code.replace(shown, real)
    ended = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, timeout=120,
                           check=False)
    if ended.returncode != 0:
        raise AssertionError(f"the example failed: {ended.stderr}")
    missing = [name for name in expected if not (pathlib.Path(folder) / name).is_file()]
    if missing:
        raise AssertionError(f"the example wrote no {', '.join(missing)}")


if __name__ == "__main__":
    run(*sys.argv[1:5], sys.argv[5:])

#!/usr/bin/env python3
"""Runs the first ```python block of a document as it stands there, but for the address and the keys.

Usage: run_block.py FILE ENDPOINT KEYS|- [EXPECTED_OUTPUT_FILE...]   (in an empty folder; - = without keys)
"""

import pathlib
import re
import sys


def first_block(text):
    found = re.search(r"^```python\n(.*?)^```", text, re.S | re.M)
    if found is None:
        sys.exit("the document shows no Python any more")
    return found[1]


def main():
    document, where, keys, *expected = sys.argv[1:]
    code = first_block(pathlib.Path(document).read_text())
    for shown, real in (('"tcp://127.0.0.1:7420"', repr(where)), ('"~/.tessera"', "None" if keys == "-" else repr(keys))):
        if shown not in code:
            sys.exit(f"the example no longer shows {shown}")
        code = code.replace(shown, real)
    exec(compile(code, document, "exec"), {"__name__": "__main__"})
    missing = [name for name in expected if not pathlib.Path(name).is_file()]
    if missing:
        sys.exit(f"the example wrote no {', '.join(missing)}")


if __name__ == "__main__":
    main()

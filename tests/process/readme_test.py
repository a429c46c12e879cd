#!/usr/bin/env python3
"""Runs the README's own command lines (those of build/release/bin), so that the first page stays true.

Usage: readme_test.py SOURCE_FOLDER BIN_FOLDER
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile


def commands(readme: str) -> list[str]:
    lines = []
    for block in re.findall(r"```sh\n(.*?)```", readme, re.S):
        for line in block.splitlines():
            if line.startswith("build/release/bin/"):
                lines.append(line.split("#")[0].strip())
    return lines


def main() -> int:
    source, programs = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    lines = commands((source / "README.md").read_text())
    if not lines:
        print("the README shows no command any more")
        return 1
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        for line in lines:
            words = shlex.split(line)
            words[0] = str(programs / pathlib.Path(words[0]).name)
            words = [str(source / w) if w.startswith("tests/scenes/") else w for w in words]
            result = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
            outputs = [words[i + 1] for i, w in enumerate(words) if w == "-o"]
            missing = [o for o in outputs if not (pathlib.Path(folder) / o).is_file()]
            ok = result.returncode == 0 and not missing
            failures += not ok
            print("ok  " if ok else "FAIL", line, *(f"(no {m})" for m in missing))
            if not ok:
                print(result.stderr)
    return 1 if failures else 0


sys.exit(main())

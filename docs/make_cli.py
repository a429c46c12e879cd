#!/usr/bin/env python3
"""Writes docs/cli.md from what the programs say with --help. Usage: docs/make_cli.py BIN_FOLDER > docs/cli.md

`tessera bench` is left out: it is built for benchmarks alone (docs/benchmarks.md).
"""

import pathlib
import re
import subprocess
import sys

PROGRAMS = ("tessera", "tessera-master", "tessera-node", "tessera-display")

INTRODUCTION = """\
# Programs

Written by `docs/make_cli.py` from `--help`. `deploy/docs.sh` makes man pages of it, and the reference of the C++ client.

Every program has `--help` with examples, `--version`, and reads its options also from a TOML file (`--config FILE`: the
option names without dashes as keys, one table per sub-command). `deploy/completions/tessera.bash` completes commands, options and
their choices in bash.

## Exit codes

| code | meaning |
|---|---|
| 0 | done |
| 1 | `compare`: the pictures differ more than allowed |
| 2 | bad input: a file is missing, damaged or of the wrong kind; no output was written |
| 64 | wrong options; the message names the nearest valid one |
| 65 | `edit`: a mistake in a script; nothing was changed |
| 69 | unavailable: no master answers, no nodes came, a back-end cannot start |
| 70 | a broken promise of our own; please report it |
| 74 | the output could not be written |
| 75 | the cluster is busy and `--no-wait` was given: try again later |
| 77 | refused: the key, its role or the protocol version |
| 130 | interrupted; what was merged is written |
"""


def help_of(command):
    """The help of a command, without spaces at the ends of lines."""
    text = subprocess.run([*command, "--help"], capture_output=True, text=True, check=True).stdout
    return "\n".join(line.rstrip() for line in text.strip().split("\n"))


def commands_in(text):
    listed = re.search(r"^Subcommands:\n((?:  .*\n?)+)", text, re.M)
    return re.findall(r"^  ([a-z][a-z-]*)", listed.group(1), re.M) if listed else []


def sections(folder, words):
    text = help_of([str(folder / words[0]), *words[1:]])
    yield f"## {' '.join(words)}\n\n```\n{text}\n```\n"
    for command in commands_in(text):
        if command != "bench":
            yield from sections(folder, [*words, command])


def main():
    folder = pathlib.Path(sys.argv[1])
    print(INTRODUCTION)
    print("\n".join(section for program in PROGRAMS for section in sections(folder, [program])), end="")


main()

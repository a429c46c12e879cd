#!/usr/bin/env python3
"""Puts defects that were mended back into a copy of the tree, one by one, and checks that the fuzzer finds each.

Usage: defects_test.py ROOT [--build FOLDER] [--seeds N] [NAME...]. `defects/NAME.patch` says above its first difference what it
breaks. Without --build: the patches apply to the tree. With it, tessera_fuzz is built with each of them and run with the seeds
from 1 on until an invariant is violated. Exits 1 when a patch does not apply, or none of the seeds finds its defect.
"""

import argparse
import filecmp
import os
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
MESSAGES = 25_000  # of a seed, as in the tests


def run(*command, cwd, may_fail=False):
    done = subprocess.run([str(part) for part in command], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    if done.returncode != 0 and not may_fail:
        raise RuntimeError(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}")
    return done


def mirror(root, to):
    """Copies what differs, so that only what a patch touches is compiled again."""
    names = [name for name in run("git", "ls-files", "-z", cwd=root).stdout.split("\0") if name and (root / name).is_file()]
    for name in names:
        if not (to / name).is_file() or not filecmp.cmp(root / name, to / name, shallow=False):
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / name, to / name)


def build(tree, folder):
    run("cmake", "--preset", "release", "-B", folder, cwd=tree)
    run("ninja", "-C", folder, "tessera_fuzz", cwd=tree)
    return folder / "tests" / "tessera_fuzz"


def finding(fuzz, seeds):
    """What the fuzzer found, with its seed; None if it found nothing. A crash is a finding, too."""
    for seed in range(1, seeds + 1):
        done = run(fuzz, "--seed", seed, "--messages", MESSAGES, cwd=fuzz.parent, may_fail=True)
        if done.returncode != 0:
            violated = re.findall(r"^violated: (.*)$", done.stdout, re.M)
            return f"seed {seed}: {violated[0][:200] if violated else f'exit code {done.returncode}'}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, metavar="FOLDER")
    parser.add_argument("--seeds", type=int, default=8, help="to try at most (default: %(default)s)")
    parser.add_argument("names", nargs="*", help="of defects (default: all)")
    options = parser.parse_intermixed_args()
    root = options.root.resolve()
    patches = [patch for patch in sorted((HERE / "defects").glob("*.patch")) if not options.names or patch.stem in options.names]
    missed = []
    for patch in patches:
        applies = run("git", "apply", "--check", patch, cwd=root, may_fail=True)
        if applies.returncode != 0:
            missed.append(patch.stem)
            print(f"FAIL {patch.stem} does not apply\n{applies.stdout}")
        elif not options.build:
            print("ok  ", patch.stem)
        else:
            tree = options.build.resolve() / "tree"
            tree.mkdir(parents=True, exist_ok=True)
            mirror(root, tree)
            os.environ["GIT_CEILING_DIRECTORIES"] = str(tree.parent)  # else a repository around it hides its files
            run("git", "apply", patch, cwd=tree)
            found = finding(build(tree, options.build.resolve() / "build"), options.seeds)
            print("ok   " if found else "FAIL ", patch.stem, ": ", found or "not found", sep="", flush=True)
            if not found:
                missed.append(patch.stem)
    return 1 if missed or not patches else 0


sys.exit(main())

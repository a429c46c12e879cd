#!/usr/bin/python3
"""Builds the fuzzers of all decoders with clang (preset `fuzz`) and runs them on their corpus.

What a decoder does wrong is reported with the command that shows it again, and its input is kept in
build/fuzz/findings. Fix it, and add the input to tests/fuzz/decoders/corpus/DECODER under a name that says what was
wrong with it.

Exit code: 0 = nothing was found, 1 = there are findings, 2 = a fuzzer cannot be built or run, 64 = wrong options.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CORPUS = ROOT / "tests/fuzz/decoders/corpus"
BUILD = ROOT / "build/fuzz"
PROGRAM = BUILD / "bin/fuzz_decoders"
FINDINGS = BUILD / "findings"
# Inputs for each decoder with --ci: what takes some 10 s on two slow cores. A number, since a time would let a fast machine find
# by chance what others did not. Still slower machines stop after CI_SECONDS: they try the first of the same inputs.
CI_SEED = 1
CI_SECONDS = 12
CI_INPUTS = {"obj": 300, "stl": 1500, "gltf": 4000, "x3d": 4000, "display": 6000, "tessera": 9000, "exr": 9000, "toml": 10000, "ply": 10000,
             "checkpoint": 12000, "journal": 16000, "transfer": 22000, "edit": 32000, "keys": 32000, "control": 36000,
             "checkpoint-state": 36000, "change-list": 45000, "journal-record": 50000}
OTHER_CI_INPUTS = 60000
LIMITS = ["-timeout=20", "-rss_limit_mb=2048", "-malloc_limit_mb=1024"]


class CannotRun(Exception):
    pass


def output_of(*command):
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        raise CannotRun(f"{' '.join(map(str, command))}\n{done.stdout[-8000:]}")
    return done.stdout


def build(jobs):
    output_of("cmake", "--preset", "fuzz")
    output_of("cmake", "--build", "--preset", "fuzz", "--parallel", str(jobs))


def fuzz(decoder, options, folder):
    """Runs one fuzzer; returns its inputs a second and what it found: lines of text."""
    scratch = folder / decoder
    seeds, new, temporary = scratch / "seeds", scratch / "new", scratch / "files"
    for each in (seeds, new, temporary):
        each.mkdir(parents=True)
    output_of(PROGRAM, f"--decoder={decoder}", f"--seeds={seeds}")
    folders = [new, seeds] + [each for each in [CORPUS / decoder] if each.exists()]
    known = set(FINDINGS.glob(f"{decoder}-*"))
    dictionary = Path(__file__).parent / "dictionaries" / f"{decoder}.dict"
    environment = {**os.environ, "TMPDIR": str(temporary)}
    environment.setdefault("ASAN_SYMBOLIZER_PATH", "/usr/bin/addr2line")
    if options.ci:
        extent = [f"-runs={CI_INPUTS.get(decoder, OTHER_CI_INPUTS)}", f"-max_total_time={CI_SECONDS}", f"-seed={CI_SEED}"]
    else:
        extent = [f"-max_total_time={options.seconds}", f"-seed={options.seed}"]
    command = [PROGRAM, f"--decoder={decoder}", *extent,
               f"-artifact_prefix={FINDINGS}/{decoder}-", "-print_final_stats=1", *LIMITS]
    if dictionary.exists():
        command.append(f"-dict={dictionary}")
    done = subprocess.run(command + folders, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env=environment, errors="replace", text=True, check=False)
    rate = re.search(r"average_exec_per_sec:\s*(\d+)", done.stdout)
    inputs = sorted(set(FINDINGS.glob(f"{decoder}-*")) - known)
    if done.returncode == 0 and not inputs:
        return int(rate[1]) if rate else 0, []
    causes = re.findall(r"^(?:broken promise: .*|SUMMARY: .*|.*runtime error: .*|==\d+== ?ERROR: .*)$", done.stdout, re.M)
    lines = list(dict.fromkeys(causes)) or [done.stdout[-4000:]]
    again = PROGRAM.relative_to(ROOT)
    lines += [f"  {again} --decoder={decoder} {' '.join(LIMITS)} {each.relative_to(ROOT)}" for each in inputs]
    return int(rate[1]) if rate else 0, lines


def parsed_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.error = lambda message: (print(f"run.py: {message}; see --help", file=sys.stderr), sys.exit(64))
    parser.add_argument("decoders", nargs="*", metavar="DECODER", help="which (default: all)")
    parser.add_argument("--seconds", type=int, default=10, help="for each decoder (default: 10)")
    parser.add_argument("--seed", type=int, default=0, help="of the mutations (default: 0, another one in each run)")
    parser.add_argument("--ci", action="store_true", help="a fixed number of inputs instead, about 10 s for each decoder")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time (default: one for each core)")
    parser.add_argument("--list", action="store_true", help="list the decoders")
    return parser, parser.parse_args()


def main():
    parser, options = parsed_options()
    build(options.jobs)
    known = output_of(PROGRAM, "--list").split()
    if options.list:
        print("\n".join(known))
        return 0
    for name in options.decoders:
        if name not in known:
            parser.error(f"no decoder '{name}': it is one of {', '.join(known)}")
    FINDINGS.mkdir(exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix="tessera-fuzz-"))
    found = 0
    try:
        with ThreadPoolExecutor(options.jobs) as pool:
            names = options.decoders or known
            for name, (rate, lines) in zip(names, pool.map(lambda each: fuzz(each, options, folder), names)):
                print(f"{name}: {rate} inputs/s" + (", FOUND:" if lines else ""), *lines, sep="\n", flush=True)
                found += 1 if lines else 0
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    if found:
        print(f"{found} decoders with findings: each command above shows one again")
    return 1 if found else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except CannotRun as error:
        print(f"run.py: this failed: {error}", file=sys.stderr)
        sys.exit(2)

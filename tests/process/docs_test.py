#!/usr/bin/env python3
"""Keeps the documents true: runs the commands of README.md and docs/getting-started.md, finds options that do not exist, and
makes docs/cli.md again.

Usage: docs_test.py SOURCE_FOLDER BIN_FOLDER
"""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))
from ports import free_port  # noqa: E402

PATIENCE = 240  # seconds a whole page may take on a busy machine
# Options of scripts, CMake, CTest and others that the documents name.
FOREIGN = {"--ci", "--docs", "--fix", "--live", "--long", "--once", "--preset", "--wall", "--scope"}


def blocks(page: pathlib.Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.M | re.S)


def script_of(page: pathlib.Path, port: int) -> str:
    """All of its commands but those that build, as one script with a port of its own."""
    lines = []
    for block in blocks(page, "sh"):
        lines += [line for line in block.splitlines() if not line.startswith(("./deploy/", "export PATH"))]
    text = "\n".join(lines).replace("build/release/bin/", "").replace("127.0.0.1:7420", f"127.0.0.1:{port}")
    text = re.sub(r"^tessera-master ", rf"tessera-master --listen tcp://127.0.0.1:{port} ", text, flags=re.M)
    # A reader takes a moment between a start and the next command, and sees what still runs.
    stop = "trap 'for job in $(jobs -p); do kill -9 $job || true; done' EXIT"
    return f"set -e -o pipefail\n{stop}\nset -x\n" + re.sub(r" &$", " & sleep 1", text, flags=re.M)


def run_page(source: pathlib.Path, programs: pathlib.Path, name: str) -> bool:
    script = script_of(source / name, free_port())
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "tests").symlink_to(source / "tests")
        environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "HOME": folder}
        with subprocess.Popen(["bash", "-c", script], cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, start_new_session=True) as shell:
            try:
                said, _ = shell.communicate(timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                os.killpg(shell.pid, signal.SIGKILL)
                said, _ = shell.communicate()
                said += f"\nnot finished after {PATIENCE} s"
        outputs = re.findall(r" -o (\S+\.\w+)", script)
        missing = [output for output in outputs if not (pathlib.Path(folder) / output).is_file()]
    fine = shell.returncode == 0 and not missing and len(outputs) > 0
    print("ok  " if fine else "FAIL", name, *(f"(no {output})" for output in missing))
    if not fine:
        print(script, said, sep="\n\n")
    return fine


def options_of(program: list[str]) -> set[str]:
    """Of a program and all of its sub-commands, by their help; of `tessera bench` only where the benchmarks are built."""
    text = subprocess.run([*program, "--help"], capture_output=True, text=True, check=program[-1] != "bench").stdout
    found = set(re.findall(r"--[a-z][a-z-]+", text))
    listed = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.M)
    for command in re.findall(r"^  ([a-z][a-z-]*)", listed.group(1), re.M) if listed else []:
        found |= options_of([*program, command])
    return found


def options_exist(source: pathlib.Path, programs: pathlib.Path) -> bool:
    known = set(FOREIGN)
    for program in ("tessera", "tessera-master", "tessera-node", "tessera-display"):
        known |= options_of([str(programs / program)])
    known |= options_of([sys.executable, str(source / "tests" / "bench" / "wire" / "wire_bench.py")])
    known |= options_of([str(programs.parent / "tests" / "tessera_fuzz")])
    known |= options_of([sys.executable, str(source / "tests" / "fuzz" / "defects_test.py")])
    known |= options_of([sys.executable, str(source / "tests" / "chaos" / "chaos.py")])
    known |= options_of([sys.executable, str(source / "tests" / "chaos" / "soak.py")])
    known |= options_of([sys.executable, str(source / "tests" / "chaos" / "slow.py")])
    known |= options_of([sys.executable, str(source / "tests" / "fuzz" / "decoders" / "run.py")])
    wrong = []
    has_bench = (programs / "tessera-bench").exists()
    for page in [source / "README.md", *sorted((source / "docs").glob("*.md"))]:
        if page.name == "benchmarks.md" and not has_bench:
            continue
        for option in sorted(set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", page.read_text())) - known):
            wrong.append(f"{page.relative_to(source)}: there is no option {option}")
    print("\n".join([*wrong, f"{len(wrong)} options that do not exist"]))
    return not wrong


def cli_is_current(source: pathlib.Path, programs: pathlib.Path) -> bool:
    made = subprocess.run([sys.executable, str(source / "docs" / "make_cli.py"), str(programs)], capture_output=True, text=True,
                          check=True).stdout
    fine = made == (source / "docs" / "cli.md").read_text()
    print("ok   docs/cli.md" if fine else "FAIL docs/cli.md is not what --help says: docs/make_cli.py build/release/bin > docs/cli.md")
    return fine


def main() -> int:
    source, programs = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    fine = [options_exist(source, programs), cli_is_current(source, programs), run_page(source, programs, "README.md"),
            run_page(source, programs, "docs/getting-started.md")]
    return 0 if all(fine) else 1


sys.exit(main())

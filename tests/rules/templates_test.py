#!/usr/bin/env python3
"""Adds what the README says how to add, each to a copy of the tree: a field, a filter, a back-end, a message.

Usage: templates_test.py ROOT [--build FOLDER]. `templates/NAME.patch` is applied, after `NAME.sh` where there is one. Above
its first difference it says in words what it adds, and

    Files: N       how many files of the product it may touch, new ones left out
    Targets: ...   what --build builds
    Tests: REGEX   what it runs then

Without --build: the templates apply, and the tree keeps its rules once it is formatted. With it, their tests pass as well. Exits 1
when a template fails.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PRODUCT = re.compile(r"^(proto|mediator|backends|node|master|client)/")


def run(*command, cwd, **options):
    done = subprocess.run([str(part) for part in command], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False, **options)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}")
    return done.stdout


def copy_tree(root, to):
    for name in run("git", "ls-files", "-z", cwd=root).split("\0"):
        if name and (root / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, to / name)


def header(patch):
    """What stands above the first difference, by keyword."""
    text = patch.read_text().split("\ndiff ", 1)[0]
    return dict(re.findall(r"^(Files|Targets|Tests): (.*)$", text, re.M))


def changed(patch):
    """The files that a patch touches, and those of them that it makes."""
    text = patch.read_text()
    return set(re.findall(r"^\+\+\+ b/(\S+)", text, re.M)), set(re.findall(r"^--- /dev/null\n\+\+\+ b/(\S+)", text, re.M))


def add(root, patch, to):
    """Makes a copy of the tree with the template in it."""
    copy_tree(root, to)
    script = patch.with_suffix(".sh")
    if script.exists():
        run("bash", script, cwd=to)
    # Outside of a repository, whatever lies above the copy.
    run("git", "apply", patch, cwd=to, env={**os.environ, "GIT_CEILING_DIRECTORIES": str(to.parent)})
    touched, made = changed(patch)
    product = [name for name in touched - made if PRODUCT.match(name) and not name.endswith("CMakeLists.txt")]
    if len(product) > int(header(patch)["Files"]):
        raise RuntimeError(f"it touches {len(product)} files of the product: {', '.join(sorted(product))}")
    run("clang-format-14", "-i", *(name for name in touched if name.endswith((".h", ".cpp"))), cwd=to)
    run(sys.executable, to / "tests/rules/check_rules.py", to, cwd=to)


def build(patch, copy, folder):
    says = header(patch)
    run("cmake", "-S", copy, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
        "-DCMAKE_UNITY_BUILD_BATCH_SIZE=12", cwd=copy)
    run("cmake", "--build", folder, "--parallel", os.cpu_count() or 1, "--target", *says["Targets"].split(), cwd=copy)
    ran = run("ctest", "--test-dir", folder, "--output-on-failure", "-R", says["Tests"], cwd=copy)
    if "No tests were found" in ran:
        raise RuntimeError(f"no test is called {says['Tests']}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path)
    arguments = parser.parse_args()
    failed = False
    for patch in sorted((HERE / "templates").glob("*.patch")):
        with tempfile.TemporaryDirectory() as temporary:
            copy = arguments.build / patch.stem / "tree" if arguments.build else pathlib.Path(temporary) / "tree"
            shutil.rmtree(copy, ignore_errors=True)
            copy.mkdir(parents=True)
            try:
                add(arguments.root.resolve(), patch, copy)
                if arguments.build:
                    build(patch, copy, arguments.build / patch.stem / "build")
                print(f"{patch.stem}: fine")
            except RuntimeError as error:
                failed = True
                print(f"{patch.stem}: {error}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

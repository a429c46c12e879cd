"""What the scripts of this folder share as commands: their arguments, and how they end."""

import argparse
import pathlib
import sys

import world  # noqa: F401  # finds the next one
from cluster import ClusterError, load_package


def wrong_use(text):
    print(f"{pathlib.Path(sys.argv[0]).name}: {text}; see --help", file=sys.stderr)
    sys.exit(64)


def new_parser(text):
    """text: the docstring of the script."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.error = wrong_use
    parser.add_argument("programs", type=pathlib.Path, help="bin folder of a build")
    parser.add_argument("python", type=pathlib.Path, help="python folder of a build")
    return parser


def package(options):
    """The Python package `tessera` of the build."""
    try:
        return load_package(options.python)
    except ClusterError as error:
        wrong_use(str(error))


def end_with(main):
    """Ends the process with what main() returns; 130 after Ctrl-C."""
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)

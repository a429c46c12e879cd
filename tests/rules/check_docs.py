#!/usr/bin/env python3
"""Checks the documents: links lead somewhere, and the README stays a first page with an index of all.

Usage: check_docs.py ROOT. Prints one line per violation and exits 1 if there is any.
"""

import pathlib
import re
import sys

README_LINES, README_WIDTH = 120, 120
LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```", re.M | re.S)


def anchor(heading):
    """The fragment of a heading, as code hosts make it."""
    text = re.sub(r"[`*]", "", heading.strip().lower())
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", text))


def anchors(text):
    return {anchor(heading) for heading in re.findall(r"^#+ (.*)$", FENCE.sub("", text), re.M)}


def links(root, page):
    text = page.read_text()
    for target in LINK.findall(FENCE.sub("", text)):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, fragment = target.partition("#")
        file = page.parent / path if path else page
        if not file.exists():
            yield f"{page.relative_to(root)}: there is no '{target}'"
        elif fragment and file.suffix == ".md" and fragment not in anchors(file.read_text()):
            yield f"{page.relative_to(root)}: '{target}' names no heading"


def first_page(root):
    lines = (root / "README.md").read_text().split("\n")[:-1]
    if len(lines) > README_LINES:
        yield f"README.md: {len(lines)} lines, more than {README_LINES}"
    for number, line in enumerate(lines, 1):
        if len(line) > README_WIDTH:
            yield f"README.md:{number}: {len(line)} characters, more than {README_WIDTH}"


def index(root, pages):
    named = set(LINK.findall((root / "README.md").read_text()))
    for page in pages:
        name = str(page.relative_to(root))
        if name != "README.md" and name not in named and page.parent.name in ("docs", root.name):
            yield f"README.md: its index lacks {name}"


def check(root):
    pages = sorted([*root.glob("*.md"), *root.glob("docs/*.md")])
    found = [*first_page(root), *index(root, pages)]
    for page in pages:
        found += links(root, page)
    return found


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    violations = check(root)
    print("\n".join([*violations, f"{len(violations)} violations"]))
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Checks the include arrows, the sizes of files and functions and a few conventions that the README promises.

Usage: check_rules.py ROOT. Prints one line per violation and exits 1 if there is any.
"""

import os
import re
import sys

from functions import check_functions

CORE = ["mediator/base", "mediator/scene", "mediator/view", "mediator/frame", "mediator/filter", "mediator/display"]
KIT = CORE + ["mediator/backend", "mediator/shading"]
LINK = ["mediator/net", "mediator/session", "mediator/wire"]

# Folder or file -> what its sources may include, in addition to their own folder. The longest match counts; "" is
# the permission to include everything.
ARROWS = {
    "mediator/base": [],
    "mediator/codec": ["mediator/base"],
    "mediator/scene": ["mediator/base"],
    "mediator/frame": ["mediator/base", "mediator/scene"],
    "mediator/view": ["mediator/base", "mediator/scene", "mediator/frame"],
    "mediator/filter": ["mediator/base", "mediator/scene", "mediator/view", "mediator/frame"],
    "mediator/display": ["mediator/base", "mediator/scene", "mediator/view", "mediator/frame"],
    "mediator/shading": CORE,
    "mediator/backend": KIT,
    "mediator/picture": CORE,
    "mediator/net": CORE,
    "mediator/program": ["mediator/base"],
    "mediator/session": CORE,
    "mediator/wire": CORE + ["mediator/codec", "mediator/session", "proto"],
    "backends": KIT + ["backends"],
    "backends/null": KIT,
    "backends/embree": KIT,
    "backends/vulkan": KIT + ["backends/vulkan"],
    "node": KIT + LINK,
    "node/config.h": KIT + LINK + ["mediator/program"],
    "node/config.cpp": KIT + LINK + ["mediator/program"],
    "node/main.cpp": KIT + LINK + ["mediator/program"],
    # The rooms of the master, each of which knows those above it: view, passes, units, film, picture, delivery.
    "master/filter": KIT + ["master/filter"],
    "master/peers": CORE + LINK,
    "master/loop": CORE + LINK + ["master/peers"],
    "master/scene": CORE + LINK + ["master/peers"],
    "master/render/schedule": CORE + ["mediator/session", "mediator/wire", "master/peers"],
    "master/render/compose": CORE + ["master/filter"],
    "master/render": CORE + LINK + ["mediator/picture", "master/filter", "master/peers", "master/render"],
    "master/display": CORE + LINK + ["master/filter", "master/peers", "master/scene", "master/render"],
    "master": CORE + LINK + ["master/loop", "master/peers", "master/scene", "master/render", "master/display"],
    "master/config.h": CORE + LINK + ["mediator/program"],
    "master/config.cpp": CORE + LINK + ["mediator/program"],
    "master/main.cpp": CORE + LINK + ["mediator/picture", "mediator/program"],
    "client": CORE + LINK + ["client/import", "mediator/picture"],
    "client/session.h": CORE + ["mediator/session", "client"],
    "client/frame.h": CORE + ["mediator/session"],
    "client/render.h": ["client"],
    "client/output_event.h": CORE + ["mediator/session"],
    "client/import": CORE + ["mediator/picture", "mediator/wire"],
    "client/export": CORE + ["client/import", "mediator/picture", "mediator/wire"],
    "client/edit": CORE + ["client/import", "client/export"],
    "client/display_file": CORE + ["mediator/picture"],
    "client/main.cpp": [""],
    "client/tools": [""],
    "client/display": [""],
    "tests": [""],
}

PROGRAMS = ["mediator/program/", "client/display/", "client/tools/", "client/main.cpp", "master/main.cpp", "node/main.cpp"]
EVERYWHERE = r"\.(h|cpp)$"
SOURCES = r"\.cpp$"

# Outside library (as included) -> where it may be included, in which files.
LIBRARIES = [
    (r"zmq.*\.h(pp)?$", ["mediator/net/", "tests/net/"], EVERYWHERE),
    (r"sodium", ["mediator/base/"], SOURCES),
    (r"google/protobuf/|.*\.pb\.h$", ["mediator/wire/", "tests/wire/"], EVERYWHERE),
    (r"(spdlog|CLI|nlohmann|toml\+\+)/", PROGRAMS + ["client/display_file/", "client/import/", "tests/"], SOURCES),
    (r"embree\d/", ["backends/embree/", "backends/vulkan/bvh/", "tests/bvh/"], EVERYWHERE),
    (r"vulkan/", ["backends/vulkan/", "client/tools/", "tests/vulkan/"], EVERYWHERE),
    (r"(OpenEXR/|Imath/)?(Imf|Imath|Iex|half)\w*\.h$", ["mediator/picture/", "client/import/", "tests/"],
     EVERYWHERE),
    (r"png\.h$|jpeglib\.h$|turbojpeg\.h$", ["mediator/picture/", "tests/"], EVERYWHERE),
    (r"stb/", ["mediator/picture/", "client/import/", "tests/"], SOURCES),
    (r"tiny_gltf", ["client/import/", "client/export/", "tests/"], EVERYWHERE),
    (r"assimp/|draco/", ["client/import/", "tests/"], EVERYWHERE),
    (r"pugi", ["client/display_file/", "client/import/", "tests/"], EVERYWHERE),
    (r"zip\.h$", ["client/display_file/", "tests/"], EVERYWHERE),
    (r"SDL", ["client/display/"], SOURCES),
    (r"histedit\.h$", ["client/edit/"], SOURCES),
    (r"(gtest|gmock|benchmark)/", ["tests/"], EVERYWHERE),
]

TOP_FOLDERS = {"mediator", "backends", "node", "master", "client", "tests", "proto", "deploy"}
LIMIT, TEST_LIMIT = 450, 600
CODE = (".h", ".cpp")
MEASURED = CODE + (".proto", ".py", ".sh", ".cmake", "CMakeLists.txt", ".comp", ".glsl")
# Headers in the language that is compiled as C++ and as GLSL: GLSL knows no #pragma once, and its drivers' functions may be off by 2^-11.
SHARED_LANGUAGE = "mediator/shading/language.h"
NOT_SHARED = [
    (re.compile(r"\b(std|glm)::"), "std:: and glm:: are not GLSL"),
    (re.compile(r"\b(double|dvec[234]|static_cast|template|enum|class|using|namespace)\b"), "is not in the language"),
    (re.compile(r"\b(a?sin|a?cos|a?tan|exp2?|log2?|pow|inversesqrt|normalize|length|distance)\s*\("),
     "a driver's function: take that of maths.h"),
]
# A wall clock may be set at any time, so nothing waits by it: deadlines and intervals use Clock. since_1970() is for dates.
WALL_CLOCK = re.compile(r"\bsystem_clock\b|\bCLOCK_REALTIME\b|\bgettimeofday\b|\bhigh_resolution_clock\b")
WALL_CLOCK_FILE = "mediator/base/clock.h"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def rule_for(path):
    """The entry of ARROWS that stands for a path, longest first; None when no rule knows the folder."""
    while path:
        if path in ARROWS:
            return path
        path = os.path.dirname(path)
    return None


def may_include(path, included):
    if "/" not in included or included.split("/")[0] not in TOP_FOLDERS:
        return "is not written from the repository root"
    if included.startswith("tests/") and not path.startswith("tests/"):
        return "belongs to the tests"
    rule = rule_for(path)
    if rule is None:
        return f"has no rule in tests/rules for {os.path.dirname(path)}"
    own = os.path.dirname(path)
    target = os.path.dirname(included)
    if target == own:
        return None
    for allowed in ARROWS[rule]:
        if allowed == "" or target == allowed or target.startswith(allowed + "/"):
            return None
    return f"is not allowed for {rule}"


def may_use_library(path, included):
    for pattern, places, files in LIBRARIES:
        if re.match(pattern, included):
            if not any(path.startswith(place) for place in places):
                return "belongs only into " + ", ".join(places)
            if not path.startswith("tests/") and not re.search(files, path):
                return "belongs only into .cpp files"
    return None


def without_comments(lines):
    return re.sub(r"/\*.*?\*/|//[^\n]*", lambda found: "\n" * found.group().count("\n"), "\n".join(lines),
                  flags=re.DOTALL).split("\n")


def check_shared(path, lines):
    """A header that says SHADING_BEGIN or RECORDS_BEGIN: C++ and GLSL."""
    guard = "TESSERA_" + re.sub(r"[^A-Z0-9]", "_", path.upper())
    if f"#ifndef {guard}" not in lines or f"#define {guard}" not in lines:
        yield f"{path}: shared header without the guard {guard}"
    if path == SHARED_LANGUAGE:
        return
    for number, line in enumerate(without_comments(lines), 1):
        for pattern, reason in NOT_SHARED:
            found = pattern.search(line)
            if found:
                yield f"{path}:{number}: {found.group()}: {reason}"


def check_code(path, lines):
    for number, line in enumerate(lines, 1):
        found = INCLUDE.match(line)
        if found:
            quoted, included = found.group(1) == '"', found.group(2)
            reason = may_use_library(path, included)
            if reason is None and quoted:
                reason = may_include(path, included)
            if reason:
                yield f"{path}:{number}: include of {included} {reason}"
        elif path.endswith(".h") and re.match(r"\s*using\s+namespace\b", line):
            yield f"{path}:{number}: using namespace in a header"
        elif path != WALL_CLOCK_FILE and not path.startswith("tests/") and WALL_CLOCK.search(line):
            yield f"{path}:{number}: only {WALL_CLOCK_FILE} reads the wall clock"
    if path.endswith(".h") and {"SHADING_BEGIN", "RECORDS_BEGIN"} & {line.strip() for line in lines}:
        yield from check_shared(path, lines)
    elif path.endswith(".h") and not any(line.strip() == "#pragma once" for line in lines):
        yield f"{path}: header without #pragma once"


def check_file(path, text):
    lines = text.splitlines()
    limit = TEST_LIMIT if path.startswith("tests/") else LIMIT
    if path.endswith(MEASURED) and len(lines) > limit:
        yield f"{path}: {len(lines)} lines, more than {limit}: it holds more than one idea"
    yield from check_functions(path, text)
    if path.endswith(CODE):
        yield from check_code(path, lines)
    if path.endswith(("CMakeLists.txt", ".cmake")):
        for number, line in enumerate(lines, 1):
            if re.search(r"\bfile\s*\(\s*GLOB", line, re.IGNORECASE):
                yield f"{path}:{number}: file(GLOB): list the sources"


def files_below(root):
    for folder, folders, names in os.walk(root):
        below = os.path.relpath(folder, root)
        folders[:] = sorted(name for name in folders
                            if not name.startswith(".") and not (below == "." and name in ("build", "out")))
        for name in sorted(names):
            if name.endswith(MEASURED):
                yield os.path.normpath(os.path.join(below, name)).replace(os.sep, "/")


# What programs that use the client's library see: nothing of it, however deep, shows a type of the wire.
PUBLIC_HEADERS = ["client/session.h", "client/frame.h", "client/render.h", "client/output_event.h"]
HIDDEN_FROM_PUBLIC = ("mediator/wire/", "mediator/net/", "proto/")


def check_public_headers(root):
    """Follows the includes of the public headers; a hidden one is reported with the path to it."""
    for header in PUBLIC_HEADERS:
        ways, seen = [[header]], {header}
        while ways:
            way = ways.pop()
            path = os.path.join(root, way[-1])
            if not os.path.isfile(path):
                continue
            with open(path, encoding="utf-8") as file:
                included = [found.group(2) for found in map(INCLUDE.match, file) if found and found.group(1) == '"']
            for target in included:
                if target.startswith(HIDDEN_FROM_PUBLIC):
                    if len(way) > 1:  # else the arrow says it
                        yield f"{header}: shows {target} by way of {' -> '.join(way[1:])}"
                elif target not in seen:
                    seen.add(target)
                    ways.append(way + [target])


def check_tree(root):
    """All violations below `root`, and the number of files that were looked at."""
    violations, count = [], 0
    for path in files_below(root):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            violations += check_file(path, file.read())
        count += 1
    violations += check_public_headers(root)
    return violations, count


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 64
    violations, count = check_tree(sys.argv[1])
    for violation in violations:
        print(violation)
    print(f"{count} files, {len(violations)} violations")
    return 1 if violations or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

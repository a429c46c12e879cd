#!/usr/bin/env python3
"""Every function of the shared shading sources is named in the lists that the tests evaluate on both sides.

Usage: check_functions.py ROOT. Prints the names that are missing and exits 1 if there are any. A function counts as
named in functions/*.inc, or in a function of the tests' own headers that those call. Traversal is not looked at:
tests/bvh compares whole traversals on both sides.
"""

import glob
import os
import re
import sys

# Whole paths are compared by tests/transport; rasterised hits are compared with ray traced ones by tests/vulkan.
PATHS = ("trace.h", "path_state.h")
ELSEWHERE = ("transmittance", "raster_hit")

FUNCTION = re.compile(r"^(?:WITH_CONTEXT |COLD_NOINLINE )?inline (?!constexpr)\w+ (\w+)\(", re.MULTILINE)


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def main():
    root = sys.argv[1]
    functions = []
    for path in sorted(glob.glob(os.path.join(root, "mediator/shading/*.h"))):
        name = os.path.basename(path)
        traversal = name.startswith(("bvh_", "bvh2_"))
        if "SHADING_BEGIN" in text_of(path) and not traversal and name not in PATHS:
            functions += FUNCTION.findall(text_of(path))
    lists = glob.glob(os.path.join(root, "tests/shading/functions/*.inc"))
    own = [os.path.join(root, "tests/shading", name) for name in ("cases.h", "test_scene.h", "scene_cases.h", "media_cases.h")]
    named = {word for path in lists + own for word in re.findall(r"\w+", text_of(path))}
    named.update(ELSEWHERE)
    missing = [name for name in functions if name not in named]
    for name in missing:
        print(f"{name}: no line in tests/shading/functions")
    print(f"{len(functions)} functions, {len(missing)} missing")
    return 1 if missing or not functions or not lists else 0


if __name__ == "__main__":
    sys.exit(main())

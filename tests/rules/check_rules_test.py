#!/usr/bin/env python3
"""The checker finds what it is there to find: each case plants one violation into a clean tree."""

import os
import tempfile
import unittest

from check_rules import check_tree

HEADER = "#pragma once\n"
GUARD = "#ifndef TESSERA_MEDIATOR_SHADING_A_H\n#define TESSERA_MEDIATOR_SHADING_A_H\nSHADING_BEGIN\n"
CLEAN = {
    "mediator/shading/a.h": GUARD + "inline float f(float x) {  // no std::sin(x)\n    return sine(x);\n}\n",
    "mediator/net/channel.h": HEADER + '#include <vector>\n#include "mediator/base/clock.h"\n',
    "mediator/net/zmq_link.h": HEADER + '#include <zmq.hpp>\n',
    "mediator/wire/codec.cpp": '#include "proto/work.pb.h"\n#include "mediator/scene/scene.h"\n',
    "backends/catalog.cpp": '#include "backends/null/null_backend.h"\n',
    "backends/null/null_backend.cpp": '#include "mediator/backend/backend.h"\n',
    "node/main.cpp": '#include "mediator/program/command_line.h"\n#include <spdlog/spdlog.h>\n',
    "master/master.cpp": '#include "master/render/schedule/plan.h"\n#include "mediator/net/channel.h"\n',
    "client/tools/render.cpp": '#include "node/node.h"\n#include "master/master.h"\n',
    "tests/net/a_test.cpp": '#include "mediator/net/channel.h"\n#include <zmq.hpp>\nusing namespace std;\n',
    "CMakeLists.txt": "add_library(a a.cpp)\n",
    "build/release/bad.h": '#include "anything.h"\n',
}

# file, text, a word of the complaint
PLANTED = [
    ("mediator/base/a.h", HEADER + '#include "mediator/scene/scene.h"\n', "mediator/scene/scene.h"),
    ("mediator/scene/a.cpp", '#include "mediator/frame/image.h"\n', "mediator/frame/image.h"),
    ("mediator/wire/a.cpp", '#include "mediator/net/channel.h"\n', "mediator/net/channel.h"),
    ("mediator/wire/a.cpp", "#include <zmq.hpp>\n", "zmq.hpp"),
    ("mediator/net/a.cpp", '#include "mediator/wire/envelope.h"\n', "mediator/wire/envelope.h"),
    ("mediator/net/a.cpp", '#include "proto/work.pb.h"\n', "pb.h"),
    ("mediator/net/a.cpp", "#include <spdlog/spdlog.h>\n", "spdlog"),
    ("master/a.cpp", "#include <zmq.h>\n", "zmq.h"),
    ("master/a.cpp", '  #  include  "proto/work.pb.h"\n', "pb.h"),
    ("master/a.cpp", "#include <google/protobuf/message.h>\n", "protobuf"),
    ("master/a.cpp", '#include "backends/null/null_backend.h"\n', "backends/null"),
    ("master/a.cpp", '#include "mediator/backend/backend.h"\n', "mediator/backend"),
    ("master/a.cpp", '#include "node/node.h"\n', "node/node.h"),
    ("master/a.cpp", '#include "mediator/program/command_line.h"\n', "mediator/program"),
    ("master/render/schedule/a.cpp", '#include "mediator/net/channel.h"\n', "mediator/net"),
    ("master/render/a.cpp", '#include "master/display/display_service.h"\n', "master/display"),
    ("master/render/a.cpp", '#include "master/scene/scene_authority.h"\n', "master/scene"),
    ("master/scene/a.cpp", '#include "master/render/time_budget.h"\n', "master/render"),
    ("master/peers/a.cpp", '#include "master/scene/scene_authority.h"\n', "master/scene"),
    ("node/a.cpp", '#include "master/master.h"\n', "master/master.h"),
    ("node/a.cpp", '#include "backends/embree/embree_backend.h"\n', "backends/embree"),
    ("node/a.cpp", "#include <CLI/CLI.hpp>\n", "CLI"),
    ("backends/embree/a.cpp", '#include "mediator/net/channel.h"\n', "mediator/net"),
    ("backends/embree/a.cpp", '#include "backends/null/null_backend.h"\n', "backends/null"),
    ("backends/null/a.cpp", "#include <embree3/rtcore.h>\n", "embree3"),
    ("client/session.h", HEADER + '#include "mediator/wire/envelope.h"\n', "mediator/wire"),
    ("client/a.cpp", '#include "master/master.h"\n', "master/master.h"),
    ("client/import/a.cpp", '#include "client/session.h"\n', "client/session.h"),
    ("client/tools/a.h", HEADER + "#include <nlohmann/json.hpp>\n", ".cpp"),
    ("client/tools/a.cpp", '#include "tests/bench/bench_command.h"\n', "belongs to the tests"),
    ("client/tools/a.cpp", "#include <tiny_gltf.h>\n", "tiny_gltf"),
    ("node/a.cpp", '#include "a.h"\n', "root"),
    ("node/a.cpp", '#include "../master/master.h"\n', "root"),
    ("unheard/of/a.cpp", '#include "mediator/base/ids.h"\n', "no rule"),
    ("node/a.h", HEADER + "using namespace std;\n", "using namespace"),
    ("node/a.cpp", "const auto end = std::chrono::system_clock::now() + Limit;\n", "wall clock"),
    ("node/a.h", "struct A {};\n", "pragma once"),
    ("mediator/shading/a.h", HEADER + "SHADING_BEGIN\n", "TESSERA_MEDIATOR_SHADING_A_H"),
    ("mediator/shading/a.h", GUARD + "inline float f(float x) {\n    return sin(x);\n}\n", "maths.h"),
    ("mediator/shading/a.h", GUARD + "inline float f(float x) {\n    return std::fabs(x);\n}\n", "std::"),
    ("mediator/shading/a.h", GUARD + "struct A {\n    double x;\n};\n", "double"),
    ("node/a.cpp", "\n" * 451, "451 lines"),
    ("tests/node/a.cpp", "\n" * 601, "601 lines"),
    ("node/a.cpp", "void f() {\n" + "    g();\n" * 69 + "}\n", "f has 71 lines"),
    ("tests/node/a.py", "def f():\n" + "    g()\n" * 70, "f has 71 lines"),
    ("node/CMakeLists.txt", "file(GLOB sources *.cpp)\n", "GLOB"),
    ("deploy/cmake/a.cmake", "  FILE( glob_recurse sources *.cpp)\n", "GLOB"),
]


def violations_of(files):
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
            with open(os.path.join(root, path), "w", encoding="utf-8") as file:
                file.write(text)
        return check_tree(root)


class CheckRules(unittest.TestCase):
    def test_a_clean_tree_passes(self):
        violations, count = violations_of(CLEAN)
        self.assertEqual(violations, [])
        self.assertEqual(count, len(CLEAN) - 1)  # what is below build/ is not ours

    def test_each_planted_violation_is_found(self):
        for path, text, word in PLANTED:
            with self.subTest(path=path, text=text[:60]):
                violations, _ = violations_of({**CLEAN, path: text})
                self.assertEqual(len(violations), 1, violations)
                self.assertIn(path, violations[0])
                self.assertIn(word, violations[0])

    def test_what_a_public_header_shows_by_way_of_another_is_found(self):
        violations, _ = violations_of({**CLEAN, "client/frame.h": HEADER + '#include "client/a.h"\n',
                                       "client/a.h": HEADER + '#include "mediator/wire/envelope.h"\n'})
        self.assertEqual(violations, ["client/frame.h: shows mediator/wire/envelope.h by way of client/a.h"])

    def test_the_longest_files_that_are_allowed_pass(self):
        violations, _ = violations_of({"node/a.cpp": "\n" * 450, "tests/node/a.cpp": "\n" * 600})
        self.assertEqual(violations, [])


if __name__ == "__main__":
    unittest.main()

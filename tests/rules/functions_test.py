#!/usr/bin/env python3
"""Tests of functions.py: what counts as a function, and how many lines it has."""

import unittest

from functions import LIMIT, check_functions, functions

SOURCE = r'''#include "a.h"
#define OPENS {
namespace a {
namespace {

// A comment with a { that is none.
constexpr int Many = 1'000'000;
const char* const Text = "{" R"(
{ {
)";
const std::vector<Row> Table{
    {.name = "a", .run = [](int i) {
         return i;
     }},
};
enum class Kind { A, B };

template <class T, std::size_t N = 3>
struct Box : Base<T> {
    Box() : a_{1}, b_(2) {
        c_ = {3};
    }
    explicit operator bool() const { return a_ != 0; }
    Box& operator=(const Box&) = default;
  private:
    int a_ = 0, b_{};
    std::vector<int> c_{1, 2};
};

template <class T>
auto first(const T& values,
           int otherwise = max(1, 2)) -> decltype(values.front()) {
    const auto pick = [&](int i) {
        return i;
    };
    return pick(otherwise);
}

}  // namespace

#if A
bool A::run(int value) const noexcept {
#else
#endif
    return value == '{';
}

TEST_F(Fixture, Holds) {
    EXPECT_TRUE(true);
}

}  // namespace a
'''

SHADER = """void main() {
    if (true) {
    }
}
"""

PYTHON = """class A:
    def run(self):
        def inner():
            pass
        return inner
"""


class Functions(unittest.TestCase):
    def test_each_function_once_with_its_lines(self):
        self.assertEqual(functions("a.cpp", SOURCE), [
            ("Box", 20, 3),
            ("operator bool", 23, 1),
            ("first", 31, 7),
            ("A::run", 42, 5),
            ("Fixture, Holds", 48, 3),
        ])

    def test_shaders_and_python(self):
        self.assertEqual(functions("a.comp", SHADER), [("main", 1, 4)])
        self.assertEqual(functions("a.py", PYTHON), [("run", 2, 4), ("inner", 3, 2)])
        self.assertEqual(functions("a.md", "void f() {}"), [])

    def test_only_what_is_too_long_is_named(self):
        for lines in (LIMIT, LIMIT + 1):
            text = "void f() {\n" + "    g();\n" * (lines - 2) + "}\n"
            found = list(check_functions("a.cpp", text))
            self.assertEqual(len(found), lines - LIMIT, found)
        self.assertIn("a.cpp:1: f has 71 lines", found[0])

    def test_a_table_is_no_function(self):
        text = "const std::vector<int> Table{\n" + "    1,\n" * 100 + "};\nvoid f() {\n}\n"
        self.assertEqual(functions("a.cpp", text), [("f", 103, 2)])


if __name__ == "__main__":
    unittest.main()

"""How long functions are: C++ (and GLSL) by matching braces, Python by its syntax tree.

A function is what has a body outside of any other: a lambda counts for the function that it stands in. Its lines go from the one its
declaration begins on, after comments and templates, to that of its closing brace.
"""

import ast
import re

LIMIT = 70

# Comments, raw strings, strings, characters (not the ' between digits) and preprocessor lines.
HIDDEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'|'
    r"^[ \t]*#(?:[^\n\\]|\\\n|\\.)*", re.DOTALL | re.MULTILINE)
SCOPE = re.compile(r"\b(namespace|class|struct|union|enum|extern)\b")
TEMPLATE = re.compile(r"\s*template\s*<")


def visible(text):
    """The text without what may hold braces that are none; lines stay where they are."""
    def blank(found):
        mark = "" if found.group().startswith(("/", "#")) or found.group().lstrip().startswith("#") else "0"
        return mark + "\n" * found.group().count("\n")
    return HIDDEN.sub(blank, text)


def without_template(head):
    """A declaration without the template<...> before it."""
    while found := TEMPLATE.match(head):
        depth, at = 1, found.end()
        while at < len(head) and depth:
            depth += {"<": 1, ">": -1}.get(head[at], 0)
            at += 1
        head = head[at:]
    return head


def top_level(head):
    """The head with everything in parentheses, brackets and angle brackets of templates left out."""
    result, depth = [], 0
    for char in head:
        if char in "([":
            depth += 1
        if depth == 0:
            result.append(char)
        if char in ")]":
            depth -= 1
            if depth == 0:
                result.append("()" if char == ")" else "[]")
    return "".join(result)


def opens(head):
    """What the brace after `head`, at namespace or class scope, begins: "scope", "function" or "value"."""
    text = top_level(without_template(head)).strip()
    if "()" not in text:
        return "scope" if SCOPE.search(text) and "=" not in text else "value"
    before_call, after_call = text.split("()", 1)
    if "operator" not in before_call and re.search(r"(?<![=!<>])=(?!=)", before_call):
        return "value"  # what is assigned
    if re.match(r"\s*(alignas|__attribute__|\[\[)", text) and SCOPE.search(text):
        return "scope"
    # A member that a constructor initialises with braces: its name stands right before them.
    initialised = re.search(r"(?<!:):(?!:)(.*)$", after_call, re.DOTALL)
    if initialised and re.search(r"[\w>]\s*$", text):
        return "value"
    return "function"


def name_of(head):
    text = top_level(without_template(head))
    found = re.search(r"([\w:~]+|operator\s*\S+?)(?:<[^()]*>)?\s*\(\)", text)
    name = found.group(1) if found else "?"
    if re.fullmatch(r"TEST(_[FP])?", name):
        return re.sub(r"\s+", " ", re.search(r"\((.*?)\)", head, re.DOTALL).group(1))
    return name


def cpp_functions(text):
    """(name, first line, lines) of each function, in order."""
    code = visible(text)
    at, head_start = 0, 0
    result = []
    closers = []  # of the scopes that are open
    while at < len(code):
        char = code[at]
        if char == ";" and not in_parentheses(code, head_start, at):
            head_start = at + 1
        elif char == "}":
            if closers:
                closers.pop()
            head_start = at + 1
        elif char == ":" and re.search(r"\b(public|private|protected)\s*$", code[head_start:at]):
            head_start = at + 1
        elif char == "{":
            head = code[head_start:at]
            kind = "value" if in_parentheses(code, head_start, at) else opens(head)
            if kind == "scope":
                closers.append(at)
                head_start = at + 1
            else:
                end = matching(code, at)
                if kind == "function":
                    start = head_start + len(head) - len(without_template(head).lstrip())
                    first, last = code.count("\n", 0, start) + 1, code.count("\n", 0, end) + 1
                    result.append((name_of(head), first, last - first + 1))
                    head_start = end + 1
                at = end
        at += 1
    return result


def in_parentheses(code, start, at):
    part = code[start:at]
    return part.count("(") > part.count(")")


def matching(code, at):
    depth = 0
    while at < len(code):
        depth += {"{": 1, "}": -1}.get(code[at], 0)
        if depth == 0:
            return at
        at += 1
    return len(code) - 1


def python_functions(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node.name, node.lineno, node.end_lineno - node.lineno + 1


def functions(path, text):
    if path.endswith((".h", ".cpp", ".comp", ".glsl", ".frag", ".vert")):
        return cpp_functions(text)
    return list(python_functions(text)) if path.endswith(".py") else []


def check_functions(path, text):
    for name, line, lines in functions(path, text):
        if lines > LIMIT:
            yield f"{path}:{line}: {name} has {lines} lines, more than {LIMIT}: it does more than one thing"

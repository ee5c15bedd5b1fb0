#!/usr/bin/env python3
"""Each named number of the sources says what kind of number it is, in the comment beside or above it.

    constants.py ROOT            check the folders that are done; exit status 1 if a number has no kind
    constants.py ROOT --count    table: constants by folder and kind
    constants.py ROOT --list [FOLDER...]   constants and literals without a kind
    constants.py ROOT --defaults [FOLDER...]  FILE:NAME and the tests that it names

A number is `#define NAME 1e-3`, `const double name = 8 * DBL_EPSILON` or `enum { NAME = 12 }` with a value that is known
when it is compiled. Also a literal with an exponent (1e-6) elsewhere in code, which has a name or a kind. The kinds:

    Derived:     how the value follows, or the measurement that gives it
    Default:     what it trades, and `Test: NAME` of a test that fails when the value is tenfold or a tenth
    Limit:       bounds memory, time or a format; beyond it there is a clear message or a slower way, never another result
    Layout:      places, sizes and lengths of pictures and pages
    Definition:  of mathematics, physics, units, a published method, a format; sizes of arrays
    Chosen:      by judgement or trials, with neither derivation nor test: what is left to do; new ones are not accepted
"""
import os
import re
import sys

KINDS = ["Derived", "Default", "Limit", "Layout", "Definition", "Chosen"]

# Files, folders, and with a / at the end whole trees, whose constants all have a kind, and stay so.
DONE = """
components src/accuracy src/analysis src/base src/beam_error src/cli src/codegen src/component src/draw src/export
src/expr src/formulate/ src/graph src/html src/import src/integrate src/integrate/implicit src/io src/live src/numeric
src/report src/sim src/solve/batch src/solve/constraint src/solve/evaluator src/solve/initial src/solve/output_error
src/solve/run src/solve/singular src/study
""".split()

# Constants of kind Chosen there: fewer each time, never more.
MOST_CHOSEN = 9

KIND = re.compile(r"\b(" + "|".join(KINDS) + r"):")
TEST = re.compile(r"\bTests?: *([\w.+-]+(?:, *[\w.+-]+)*)")
NUMBER = r"(?<![A-Za-z_0-9.])(?:0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[uUlLfFqQ]*"
EXPONENT = re.compile(r"(?<![A-Za-z_0-9.])(?:\d+\.?\d*|\.\d+)[eE][+-]?\d+")
TYPES = "double|float|int|long|unsigned|size_t|ssize_t|uint8_t|uint16_t|uint32_t|uint64_t|int32_t|int64_t|__float128|ct_real"
DECLARATION = re.compile(
    r"^[ \t]*(?:static[ \t]+)?const[ \t]+(?:(?:" + TYPES + r")[ \t]+)+(?=\w+\s*=)", re.M)
DEFINE = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]+(.+)$", re.M)
ENUM = re.compile(r"^[ \t]*enum\s*\{([^}]*)\}", re.M)
# names that may stand in a value that is known when it is compiled
KNOWN = re.compile(r"^(?:[A-Z][A-Z_0-9]*|" + TYPES + r"|sizeof|sqrt|acos|cos|sin)$")


def split_comments(text):
    """Code with comments and strings blanked, and the comment of each line; both keep lines and columns."""
    code, comment = list(text), [" "] * len(text)
    for m in re.finditer(r'//(?:[^\n\\]|\\[^\n])*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', text, re.S):
        is_comment = m.group()[0] == "/"
        for i in range(m.start(), m.end()):
            if text[i] != "\n":
                code[i] = " " if is_comment else '"'
                if is_comment:
                    comment[i] = text[i]
    for i, c in enumerate(text):
        if c == "\n":
            comment[i] = "\n"
    return "".join(code), "".join(comment).split("\n")


def top_level(text, separator=","):
    """(start, end) of the parts of text between separators outside parentheses."""
    depth, start = 0, 0
    for i, c in enumerate(text):
        if c in "({[":
            depth += 1
        elif c in ")}]":
            depth -= 1
        elif c == separator and depth == 0:
            yield start, i
            start = i + 1
    yield start, len(text)


def is_constant(value, local):
    if not re.search(NUMBER, value) or '"' in value or "?" in value:
        return False
    bare = re.sub(NUMBER, " ", value)
    if "[" in value:
        return False
    if all(re.match(r"[01][uUlL]*$", n) for n in re.findall(NUMBER, value)):
        return False  # a flag, a bit, the smallest count
    return all(KNOWN.match(w) or w in local for w in re.findall(r"[A-Za-z_]\w*", bare))


class Constant:
    def __init__(self, path, line, last, name, value, span, form):
        self.path, self.line, self.last, self.name = path, line, last, name
        self.value, self.span, self.form = value, span, form  # span of the value in the text
        self.kind, self.tests, self.comment = None, [], ""

    @property
    def folder(self):
        return os.path.dirname(self.path)


def constants_of(path, text, code):
    found, local = [], set()
    line_of = lambda at: code.count("\n", 0, at)

    def add(name, start, end, form, first, last):
        while start < end and code[start].isspace():
            start += 1
        while end > start and code[end - 1].isspace():
            end -= 1
        found.append(Constant(path, line_of(first), line_of(last), name, text[start:end], (start, end), form))

    for m in DEFINE.finditer(code):
        name, value = m.group(1), m.group(2)
        if not name.startswith("_") and not value.rstrip().endswith("\\") and is_constant(value, ()):
            add(name, m.start(2), m.end(2), "define", m.start(), m.end())
    for m in DECLARATION.finditer(code):
        end = code.find(";", m.end())
        for s, e in top_level(code[m.end():end]):
            part = re.match(r"\s*(\w+)\s*=(?!=)", code[m.end() + s:m.end() + e])
            if not part:
                break
            start = m.end() + s + part.end()
            if not is_constant(code[start:m.end() + e], local):
                continue
            local.add(part.group(1))
            add(part.group(1), start, m.end() + e, "const", m.start(), end)
    for m in ENUM.finditer(code):
        parts = []
        for s, e in top_level(m.group(1)):
            part = re.match(r"\s*(\w+)\s*(=?)", m.group(1)[s:e])
            if part:
                parts.append((part.group(1), part.group(2), m.start(1) + s + part.end(), m.start(1) + e))
        bits = [code[s:e].strip() for _, eq, s, e in parts if eq]
        flags = len(bits) > 2 and all(re.match(r"(0|1|2|4|8|16|32|64|1u? << \w+)$", b) for b in bits)
        if flags or any(not eq for _, eq, _, _ in parts):
            continue  # names of things that are counted from 0, or bits
        for name, _, s, e in parts:
            if is_constant(code[s:e], ()) and code[s:e].strip() not in ("0", "1"):
                add(name, s, e, "enum", s + len(code[s:e]) - len(code[s:e].lstrip()), e)
                found[-1].opening = (line_of(m.start()), line_of(m.end()))
    return found


def comment_for(first, last, lines, comments, starts):
    """The comment beside lines first..last, else the block above them or above the declarations just before."""
    is_alone = lambda i: 0 <= i < len(lines) and comments[i].strip() and not lines[i].strip()
    beside = [comments[i] for i in range(first, last + 1) if lines[i].strip()]
    indent = len(comments[last]) - len(comments[last].lstrip())
    i = last + 1
    while beside and comments[last].strip() and is_alone(i) \
            and len(comments[i]) - len(comments[i].lstrip()) == indent and indent > 20:
        beside.append(comments[i])
        i += 1
    beside = " ".join(beside)
    if KIND.search(beside):
        return beside
    i = first - 1
    while i >= 0 and i in starts and not is_alone(i):
        i -= 1
    block = []
    while is_alone(i):
        block.insert(0, comments[i])
        i -= 1
    return " ".join(block + [beside])


def clean(comment):
    return re.sub(r"\s+", " ", re.sub(r"^\s*(//[/!<]*|/\*+|\*/?)|\s(//[/!<]*)\s|\*/", " ", comment)).strip()


def read(root, path):
    with open(os.path.join(root, path)) as f:
        text = f.read()
    code, comments = split_comments(text)
    lines = code.split("\n")
    found = constants_of(path, text, code)
    starts = set()
    for c in found:
        starts.update(range(c.line, c.last + 1))
    for c in found:
        c.comment = clean(comment_for(c.line, c.last, lines, comments, starts))
        if not KIND.search(c.comment) and c.form == "enum":
            first, last = c.opening
            above = clean(comment_for(first, first, lines, comments, starts - set(range(first, last + 1)) | starts))
            beside = clean(comments[last])
            c.comment = " ".join([c.comment, above, beside])
        kind = KIND.search(c.comment)
        c.kind = kind.group(1) if kind else None
        tests = TEST.search(c.comment)
        c.tests = re.split(", *", tests.group(1).rstrip(".")) if tests else []
    bare = []
    named = [c.span for c in found]
    for m in EXPONENT.finditer(code):
        if any(s <= m.start() < e for s, e in named):
            continue
        line = code.count("\n", 0, m.start())
        if code.rfind("\n#", 0, m.start()) > code.rfind("\n", 0, m.start() - 1):
            continue
        first = line
        while first > 0 and lines[first - 1].strip() and (
                lines[first - 1].rstrip()[-1] not in ";{}" or re.search(r"= *\{$", lines[first - 1].rstrip())):
            first -= 1  # to the start of the statement or the table
        if not KIND.search(comment_for(first, line, lines, comments, starts)):
            bare.append((path, line, m.group()))
    return found, bare


def sources(root):
    for top in ("src", "components"):
        for folder, folders, files in os.walk(os.path.join(root, top)):
            folders.sort()
            for f in sorted(files):
                if f.endswith((".c", ".h")):
                    yield os.path.relpath(os.path.join(folder, f), root)


def everything(root):
    found, bare = [], []
    for path in sources(root):
        f, b = read(root, path)
        found += f
        bare += b
    return found, bare


def within(path, folders):
    """Whether the file lies directly in one of the folders, or is one of them; `src/` and `src/*` take all below."""
    folder = os.path.dirname(path)
    return any(f in (folder, path) or f.endswith("/") and path.startswith(f) for f in folders)


def test_words(root):
    """Names that may be those of tests: files below tests/, and words in quotes in their meson.build files."""
    words = set()
    for folder, folders, files in os.walk(os.path.join(root, "tests")):
        folders[:] = [f for f in folders if f != "node_modules"]
        for f in files:
            stem = f.split(".")[0]
            words.update([stem, re.sub("^test_", "", stem)])
            if f == "meson.build":
                with open(os.path.join(folder, f)) as g:
                    words.update(re.findall(r"'([\w.+-]+)'", g.read()))
    return words


def count(found, bare):
    folders = sorted({c.folder for c in found} | {os.path.dirname(b[0]) for b in bare})
    width = max(map(len, folders))
    head = KINDS + ["none", "all", "literals"]
    print(f"{'':{width}}", *(f"{h:>10}" for h in head))
    total = [0] * len(head)
    for folder in folders:
        here = [c for c in found if c.folder == folder]
        row = [sum(c.kind == k for c in here) for k in KINDS + [None]]
        row += [len(here), sum(os.path.dirname(b[0]) == folder for b in bare)]
        total = [a + b for a, b in zip(total, row)]
        print(f"{folder:{width}}", *(f"{n:10}" for n in row))
    print(f"{'all':{width}}", *(f"{n:10}" for n in total))


def problems(root, folders, all_of_them=None):
    found, bare = all_of_them or everything(root)
    words = test_words(root)
    for c in found:
        if not within(c.path, folders):
            continue
        if not c.kind:
            yield f"{c.path}:{c.line + 1}: {c.name} = {c.value}: no kind of number in its comment"
        elif c.kind == "Default" and not c.tests:
            yield f"{c.path}:{c.line + 1}: {c.name}: a default names a test that fails when it is moved tenfold"
        elif c.kind == "Default":
            for t in c.tests:
                parts = t.split("_")
                if not any("_".join(parts[:i + 1]) in words for i in range(len(parts))):
                    yield f"{c.path}:{c.line + 1}: {c.name}: no test is called '{t}'"
    for path, line, literal in bare:
        if within(path, folders):
            yield f"{path}:{line + 1}: {literal}: a number without name and kind"


def main():
    root, rest = sys.argv[1], sys.argv[2:]
    if rest[:1] == ["--count"]:
        count(*everything(root))
        return 0
    if rest[:1] == ["--list"]:
        for p in problems(root, rest[1:] or ["src/", "components/"]):
            print(p)
        return 0
    if rest[:1] == ["--defaults"]:
        for c in everything(root)[0]:
            if c.kind == "Default" and within(c.path, rest[1:] or ["src/", "components/"]):
                print(f"{c.path}:{c.name}  {' '.join(c.tests)}")
        return 0
    found, bare = everything(root)
    bad = list(problems(root, rest or DONE, (found, bare)))
    chosen = sum(c.kind == "Chosen" for c in found if within(c.path, rest or DONE))
    if chosen > MOST_CHOSEN:
        bad.append(f"{chosen} constants are Chosen, {MOST_CHOSEN} were: derive the new one, or write a test that moves it")
    for p in bad:
        print(p)
    if bad:
        print("kinds of numbers: tests/style/constants.py")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

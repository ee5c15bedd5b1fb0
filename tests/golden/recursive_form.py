#!/usr/bin/env python3
"""The printed recursive form, evaluated as it stands, has the accelerations of the engine.

recursive_form.py COTREE

Models of 101 joints in chains of ten, whose mass matrix is well conditioned. The text of `equations --full` is
read: definitions in their order, then a line a speed, left = right, linear in the accelerations q''. They
are solved for and compared with the outputs of `simulate` at t = 0.
"""
import csv
import math
import os
import re
import subprocess
import sys
import tempfile

N = 101  # one more than systems whose mass matrix is printed
AXES = ["[0, 0, 1]", "[0, 1, 0]", "[1, 0, 0]"]


def joint(i, kind, axis):
    start = "b%d.tip" % (i - 1) if i % 10 else "ground"
    return ("  j%d: {type: %s, from: %s, to: b%d, axis: %s, stiffness: 3, damping: 0.2, "
            "initial: {q: %.2f, u: %.2f}}\n" % (i, kind, start, i, axis, math.sin(i), math.cos(2 * i)))


def chains(planar):
    """With springs, symbolic masses, slides; in space about three axes."""
    text = "cotree: 1\ngravity: [0, %s]\n" % ("-9.81, 0" if planar else "0, -9.81")
    text += "parameters: {l: 0.5, J: 0.02, %s}\n" % ", ".join(
        "m%d: %r" % (i, 1 + i % 3) for i in range(N))
    inertia = "J" if planar else "[J, 2*J, 2.5*J]"
    text += "bodies:\n" + "".join(
        "  b%d: {mass: m%d, inertia: %s, com: [l/3, 0, 0], points: {tip: [l, 0, 0]}}\n"
        % (i, i, inertia) for i in range(N))
    text += "joints:\n"
    for i in range(N):
        slides = i % 9 == 4
        text += joint(i, "prismatic" if slides else "revolute",
                      "[1, 0, 0]" if slides else AXES[0 if planar else i % 3])
    return text + "outputs: [%s]\n" % ", ".join("j%d.%s" % (i, s) for i in range(N) for s in "qua")


def run(cotree, *arguments):
    return subprocess.run([cotree, *arguments], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, universal_newlines=True).stdout


NAME = re.compile(r"[A-Za-z_][\w.]*'*")


def python(expression):
    """The printed expression with its names as entries of v."""
    return NAME.sub(lambda m: m.group() if m.group() in ("sin", "cos") else "v[%r]" % m.group(),
                    expression.replace("^", "**"))


def statements(lines):
    """Lines at an indent of two with those that continue them."""
    joined = []
    for line in lines:
        if line.startswith("  ") and line[2] != " ":
            joined.append(line.strip())
        elif line.strip():
            joined[-1] += " " + line.strip()
    return joined


def program(text):
    """Definitions and residuals left - right as Python, and the names of the accelerations."""
    part = text.split("\nEquations of motion\n", 1)[1].split("\nwith\n", 1)[1]
    definitions, motion = re.split(r"\nmotion: .*\n", part)
    source = []
    for line in statements(definitions.splitlines()):
        name, value = line.split(" = ", 1)
        source.append("v[%r] = %s" % (name.strip(), python(value)))
    rows = statements(motion.splitlines())
    assert len(rows) == N, len(rows)
    for i, line in enumerate(rows):
        left, right = line.split(": ", 1)[1].split(" = ")
        source.append("r[%d] = %s - (%s)" % (i, python(left), python(right)))
    unknown = sorted(set(re.findall(r"[A-Za-z_][\w.]*''", part)))
    assert len(unknown) == N, len(unknown)
    return compile("\n".join(source), "equations", "exec"), unknown


def solve(A, b):
    """Gauss elimination with row exchange."""
    n = len(b)
    for i in range(n):
        k = max(range(i, n), key=lambda k: abs(A[k][i]))
        A[i], A[k], b[i], b[k] = A[k], A[i], b[k], b[i]
        for k in range(i + 1, n):
            f = A[k][i] / A[i][i]
            if f:
                A[k] = [x - f * y for x, y in zip(A[k], A[i])]
                b[k] -= f * b[i]
    for i in reversed(range(n)):
        b[i] = (b[i] - sum(A[i][k] * b[k] for k in range(i + 1, n))) / A[i][i]
    return b


def check(cotree, name, model):
    with open(name, "w") as file:
        file.write(model)
    run(cotree, "simulate", name, "--until", "1e-6", "--samples", "2", "-o", "out.csv", "-q", "--tree",
        "joints")
    with open("out.csv") as file:
        start = {k: float(x) for k, x in next(csv.DictReader(file)).items()}
    code, unknown = program(run(cotree, "equations", name, "--full", "--tree", "joints", "-q"))
    known = {"l": 0.5, "J": 0.02, **{"m%d" % i: 1 + i % 3 for i in range(N)}}
    for i in range(N):
        known["j%d.q" % i] = start["j%d.q" % i]
        known["j%d.q'" % i] = start["j%d.u" % i]

    def residual(values):
        v, r = {**known, **values}, {}
        exec(code, {"sin": math.sin, "cos": math.cos, "v": v, "r": r})
        return [r[i] for i in range(N)]

    zero = dict.fromkeys(unknown, 0.0)
    rest = residual(zero)
    columns = [[x - y for x, y in zip(residual({**zero, u: 1.0}), rest)] for u in unknown]
    found = solve([list(row) for row in zip(*columns)], [-x for x in rest])
    want = [start[u.replace(".q''", ".a")] for u in unknown]
    scale = max(map(abs, want))
    worst = max(abs(x - y) for x, y in zip(found, want)) / scale
    print("%s: worst error of %d accelerations %.1e" % (name, N, worst))
    assert worst < 1e-10, worst


def main():
    cotree = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check(cotree, "planar.yaml", chains(True))
        check(cotree, "spatial.yaml", chains(False))
        os.chdir("/")


main()

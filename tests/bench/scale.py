#!/usr/bin/env python3
"""Time and memory of cotree against the size of a model: a table in Markdown.

scale.py COTREE [ROW...]

A row is a family of models and a command. Time is the processor's, of the whole process, the least
of three runs; memory is its largest resident size. The exponent is that of time between the last two
sizes.
"""
import math
import os
import subprocess
import sys
import tempfile

HEAD = "cotree: 1\ngravity: [0, -9.81, 0]\n"


def section(name, items):
    return name + ":\n" + "".join("  %s: {%s}\n" % item for item in items)


def bar(i, com="[0.5, 0, 0]", tip="[1, 0, 0]"):
    return ("b%d" % i, "mass: 1, inertia: 1/12, com: %s, points: {tip: %s}" % (com, tip))


def hinge(name, start, end, more=""):
    return (name, "type: revolute, from: %s, to: %s%s" % (start, end, more))


def pendulums(n):
    return HEAD + section("bodies", map(bar, range(n))) + section(
        "joints", (hinge("j%d" % i, "ground", "b%d" % i) for i in range(n)))


def chain(n):
    return HEAD + section("bodies", map(bar, range(n))) + section(
        "joints", (hinge("j%d" % i, "b%d.tip" % (i - 1) if i else "ground", "b%d" % i)
                   for i in range(n)))


def free_bodies(n):
    return HEAD + section("bodies", (("b%d" % i, "mass: 1, inertia: [0.1, 0.2, 0.3]")
                                     for i in range(n))) + section(
        "joints", (("j%d" % i, "type: free, from: ground, to: b%d" % i) for i in range(n)))


def four_bars(n, off=0):
    """n loops in a row: cranks 0 to n, couplers between them, longer and shorter by a part `off`."""
    feet = ", ".join("g%d: [%d, 0, 0]" % (i, i) for i in range(n + 1))
    bodies = [("ground", "points: {%s}" % feet)]
    bodies += [bar(i, "[0, 0.5, 0]", "[0, 1, 0]") for i in range(n + 1)]
    bodies += [bar(n + 1 + i, tip="[%r, 0, 0]" % (1 + off * (-1) ** i)) for i in range(n)]
    joints = [hinge("foot%d" % i, "ground.g%d" % i, "b%d" % i) for i in range(n + 1)]
    for i in range(n):
        joints.append(hinge("in%d" % i, "b%d.tip" % i, "b%d" % (n + 1 + i)))
        joints.append(hinge("out%d" % i, "b%d.tip" % (n + 1 + i), "b%d.tip" % (i + 1)))
    return HEAD + section("bodies", bodies) + section("joints", joints)


def four_bars_to_close(n):
    return four_bars(n, 0.02)


def four_bars_that_move(n):
    return four_bars(n) + "simulation: {duration: 0.1}\n"


def four_bars_apart(n):
    feet = ", ".join("g%d: [%d, 0, 0]" % (i, i) for i in range(2 * n))
    bodies, joints = [("ground", "points: {%s}" % feet)], []
    for i in range(0, 3 * n, 3):
        bodies += [bar(i, "[0, 0.5, 0]", "[0, 1, 0]"), bar(i + 1), bar(i + 2, "[0, 0.5, 0]", "[0, 1, 0]")]
        joints += [hinge("in%d" % i, "ground.g%d" % (2 * i // 3), "b%d" % i),
                   hinge("near%d" % i, "b%d.tip" % i, "b%d" % (i + 1)),
                   hinge("far%d" % i, "b%d.tip" % (i + 1), "b%d.tip" % (i + 2)),
                   hinge("out%d" % i, "ground.g%d" % (2 * i // 3 + 1), "b%d" % (i + 2))]
    return HEAD + section("bodies", bodies) + section("joints", joints)


def beam(n):
    return HEAD + section("bodies", [(
        "b", "type: beam, elements: %d, length: 1, E: 2e11, density: 7800, area: 1e-4, Iz: 1e-9" % n
    )]) + section("joints", [hinge("j", "ground", "b")])


def aliases(n):
    return HEAD + "parameters:\n" + "".join(
        "  p%d: &a%d %d\n  q%d: *a%d\n" % (i, i, i, i, i) for i in range(n)
    ) + section("bodies", [bar(0)]) + section("joints", [hinge("j", "ground", "b0")])


def table(n, interpolate="cubic"):
    return HEAD + section("bodies", [bar(0), bar(1)]) + section("joints", [
        hinge("j", "ground", "b0",
              ", motion: {table: table.csv, column: v, interpolate: %s}" % interpolate),
        hinge("k", "b0.tip", "b1")]) + "simulation: {duration: %r}\n" % (1e-5 * (n - 2))


def linear_table(n):
    return table(n, "linear")


def write_table(folder, n):
    with open(os.path.join(folder, "table.csv"), "w") as file:
        file.write("t,v\n")
        for i in range(n):
            file.write("%r,%r\n" % (i * 1e-5, math.sin(i * 1e-4)))


ROWS = {
    "pendulums": ("check, pendulums side by side", pendulums, ["check"], (500, 1000, 2000)),
    "four_bars": ("check, four-bars in a row", four_bars, ["check"], (100, 300, 1000)),
    "four_bars_to_close": ("check, four-bars in a row that start open by 2 %", four_bars_to_close,
                           ["check"], (100, 300, 1000)),
    "four_bars_apart": ("check, four-bars side by side", four_bars_apart, ["check"], (100, 300, 1000)),
    "four_bars_equations": ("equations of four-bars in a row", four_bars, ["equations"], (100, 300, 1000)),
    "four_bars_simulate": ("simulate, four-bars in a row", four_bars_that_move,
                           ["simulate", "-o", "out.csv"], (100, 300, 1000)),
    "beam": ("check, one planar beam, elements", beam, ["check"], (300, 600, 1000)),
    "beam_motion": ("simulate, 1 ms of that beam with radau5", beam,
                    ["simulate", "--method", "radau5", "--until", "1e-3", "-o", "out.csv"],
                    (300, 600, 1000)),
    "chain": ("check, planar chain", chain, ["check"], (2000, 5000, 10000)),
    "free": ("check, free bodies", free_bodies, ["check"], (1000, 2000, 4000)),
    "equations": ("equations --full, planar chain", chain, ["equations", "--full"],
                  (200, 400, 800)),
    "aliases": ("check, YAML with aliases", aliases, ["check"], (10000, 20000, 40000)),
    "table": ("simulate, rows of a cubic table that drives", table, ["simulate", "-o", "out.csv"],
              (75000, 150000, 300000)),
    "linear_table": ("simulate, rows of a linear table that drives", linear_table,
                     ["simulate", "-o", "out.csv"], (75000, 150000, 300000)),
}


def run(cotree, command, folder):
    """Seconds and MB of one run."""
    child = subprocess.Popen([cotree, command[0], "model.yaml", *command[1:]], cwd=folder,
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        sys.exit("scale.py: cotree %s failed" % " ".join(command))
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1e3


def main():
    cotree = os.path.abspath(sys.argv[1])
    print("| work | size | seconds | MB | exponent |\n|---|---:|---:|---:|---:|")
    for name in sys.argv[2:] or ROWS:
        what, model, command, sizes = ROWS[name]
        measured = []
        for n in sizes:
            with tempfile.TemporaryDirectory() as folder:
                with open(os.path.join(folder, "model.yaml"), "w") as file:
                    file.write(model(n))
                if model in (table, linear_table):
                    write_table(folder, n)
                measured.append(min(run(cotree, command, folder) for _ in range(3)))
        (t0, _), (t1, _) = measured[-2:]
        exponent = math.log(t1 / t0) / math.log(sizes[-1] / sizes[-2])
        print("| %s | %s | %s | %s | %.1f |" % (
            what, " / ".join(map(str, sizes)), " / ".join("%.2f" % t for t, _ in measured),
            " / ".join("%.0f" % mb for _, mb in measured), exponent), flush=True)


main()

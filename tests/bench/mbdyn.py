#!/usr/bin/env python3
"""Time to a required error of flexible mechanisms, cotree against MBDyn, in one run on one machine.

    mbdyn.py COTREE MBDYN [PROBLEM...]     prints a table in Markdown

Both programs solve the same mechanism with as many elements: cotree's of two nodes with cubic bending, MBDyn's beam3 of
three nodes. Each is compared with itself at far smaller steps, so that the error is that of time integration; the last
column tells how far the two converged motions are apart, which is the difference of the beam models and their meshes.
Time is the CPU time of the whole program, the smallest of three runs.
"""
import math
import os
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
TARGETS = (1e-3, 1e-4, 1e-6)


# ---- MBDyn's input --------------------------------------------------------------------------------

def row(v):
    return ", ".join("%.17g" % x for x in v)


def times(R, v):
    return [sum(R[i][k] * v[k] for k in range(3)) for i in range(3)]


def plus(a, b, scale=1.0):
    return [x + scale * y for x, y in zip(a, b)]


def turn(axis, angle):
    """Rotation about the axis 'x', 'y' or 'z', as rows."""
    c, s = math.cos(angle), math.sin(angle)
    i = "xyz".index(axis)
    R = [[float(r == k) for k in range(3)] for r in range(3)]
    j, k = (i + 1) % 3, (i + 2) % 3
    R[j][j] = R[k][k] = c
    R[j][k], R[k][j] = -s, s
    return R


def product(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


class Model:
    """Nodes, bodies, beams, joints and forces of one input file."""

    def __init__(self, gravity=None):
        self.node, self.element, self.count, self.gravity = [], [], {}, gravity
        self.shown = []

    def add(self, kind, text):
        self.count[kind] = self.count.get(kind, 0) + 1
        self.element.append("  %s;" % text.replace("LABEL", str(len(self.element) + 1)))

    def add_node(self, at, R):
        self.node.append((at, R))
        return len(self.node)

    def add_body(self, node, mass, at, J):
        self.add("rigid bodies", "body: LABEL, %d, %.17g, %s, diag, %s" % (node, mass, row(at), row(J)))

    def add_beam(self, at, R, length, n, law, mass, rotary):
        """n elements; law: EA, GAy, GAz, GJ, EIy, EIz; mass and rotary inertia (3) a length. The nodes, base first."""
        nodes = [self.add_node(plus(at, times(R, [length * i / (2 * n), 0, 0])), R) for i in range(2 * n + 1)]
        h = length / n
        cut = [h / 2 * (1 - 1 / math.sqrt(3)), h / 2 * (1 + 1 / math.sqrt(3))]
        for e in range(n):
            a = nodes[2 * e:2 * e + 3]
            for node, start, end, own in ((a[0], 0, cut[0], 0), (a[1], cut[0], cut[1], h / 2), (a[2], cut[1], h, h)):
                m, s = mass * (end - start), end - start
                J = [rotary[0] * s, rotary[1] * s + m * s * s / 12, rotary[2] * s + m * s * s / 12]
                self.add_body(node, m, [(start + end) / 2 - own, 0, 0], J)
            text = "linear elastic generic, diag, " + row(law)
            self.add("beams", "beam3: LABEL, %d, null, %d, null, %d, null, from nodes, %s, same, same" % (*a, text))
        return nodes

    def hold(self, a, b, places, turns):
        """Places and turns of node b against a (0: ground) that are held, along the axes of ground at the start."""
        state = lambda s: ", ".join("active" if c == "1" else "inactive" for c in s)
        (at_b, R_b) = self.node[b - 1]
        R = turn("x", 0)
        matrix = lambda M: "matr, " + ", ".join(row(r) for r in M)
        transposed = [[R_b[k][i] for k in range(3)] for i in range(3)]
        of_b = matrix(product(transposed, R))
        here = "position orientation, reference, node, %s, rotation orientation, reference, node, %s" % (of_b, of_b)
        rows = "position constraint, %s, null, orientation constraint, %s, null" % (state(places), state(turns))
        if a == 0:
            self.add("joints", "joint: LABEL, total pin joint, %d, position, null, %s, position, %s, position orientation, %s, "
                     "rotation orientation, %s, %s" % (b, here, row(at_b), matrix(R), matrix(R), rows))
            return
        (at_a, R_a) = self.node[a - 1]
        back = [[R_a[k][i] for k in range(3)] for i in range(3)]
        of_a = matrix(product(back, R))
        off = times(back, plus(at_b, at_a, -1))
        self.add("joints", "joint: LABEL, total joint, %d, position, %s, position orientation, %s, rotation orientation, %s, "
                 "%d, position, null, %s, %s" % (a, row(off), of_a, of_a, b, here, rows))

    def text(self, duration, step, method, tolerance):
        c = dict(self.count)
        head = ["begin: data; problem: initial value; end: data;", "begin: initial value;",
                "  initial time: 0; final time: %.17g; time step: %.17g;" % (duration, step),
                "  method: %s; tolerance: %g; max iterations: 40;" % (method, tolerance),
                "  derivatives tolerance: 1e-2; derivatives max iterations: 20; derivatives coefficient: 1e-6;",
                "  linear solver: naive, colamd; output: none;", "end: initial value;", "begin: control data;",
                "  output precision: 16; default output: none;", "  structural nodes: %d;" % len(self.node)]
        head += ["  %s: %d;" % (k, v) for k, v in sorted(c.items())]
        head += ["  gravity;"] if self.gravity else []
        head += ["end: control data;", "begin: nodes;"]
        for i, (at, R) in enumerate(self.node):
            head.append("  structural: %d, dynamic, %s, matr, %s, null, null, output, %s;" % (
                i + 1, row(at), ", ".join(row(r) for r in R), "yes" if i + 1 in self.shown else "no"))
        head += ["end: nodes;", "begin: elements;"] + self.element
        if self.gravity:
            g = math.sqrt(sum(x * x for x in self.gravity))
            head.append("  gravity: uniform, %s, const, %.17g;" % (row([x / g for x in self.gravity]), g))
        return "\n".join(head + ["end: elements;", ""])


# ---- the problems ---------------------------------------------------------------------------------

STIFF = 10.0  # shear stiffness over EA where the beam of cotree does not shear


def slider_crank(n):
    m = Model()
    A, I, rho = 7.854e-5, 4.909e-10, 2770
    law = lambda E: [E * A, STIFF * E * A, STIFF * E * A, E * I, E * I, E * I]
    eye = turn("x", 0)
    rotary = [2 * rho * I, 0, 0]
    crank = m.add_beam([0, 0, 0], eye, 0.152, n, law(1e9), rho * A, rotary)
    rod = m.add_beam([0.152, 0, 0], eye, 0.304, 2, law(5e7), rho * A, rotary)
    m.hold(0, crank[0], "111", "110")
    m.hold(crank[-1], rod[0], "111", "110")
    m.hold(0, rod[-1], "010", "000")
    m.add("forces", 'couple: LABEL, absolute, %d, 0., 0., 1., string, '
          '"(Time < 0.7)*0.01*(1 - exp(-Time/0.167))"' % crank[0])
    m.shown = [crank[-1], rod[2], rod[-1]]
    return m


def pendulum(n):
    m = Model([0, 0, -9.81])
    A, I, rho, E, G = 1e-4, 8e-10, 2700, 7e10, 2.7e10
    beam = m.add_beam([0, 0, 0], turn("x", 0), 1.0, n, [E * A, STIFF * E * A, STIFF * E * A, 2 * G * I, E * I, E * I],
                      rho * A, [2 * rho * I, 0, 0])
    m.hold(0, beam[0], "111", "101")
    m.add_body(beam[-1], 0.1, [0, 0, 0], [1e-12] * 3)
    m.shown = [beam[-1]]
    return m


PROBLEMS = {
    "slider_crank_flexible": dict(make=lambda: slider_crank(5), set=["n=5"], duration=1.6, samples=80, step=2e-3, steps=7, finest=1e-5, tolerance=1e-8,
                                  outputs=["big.x=crank.pin.position.x", "big.y=crank.pin.position.y",
                                           "mid.x=rod.mid.position.x", "mid.y=rod.mid.position.y",
                                           "end.x=rod.pin.position.x"], columns=["1x", "1y", "2x", "2y", "3x"]),
    "pendulum_beam_tip_mass": dict(make=lambda: pendulum(1), set=[], duration=2.0, samples=100, step=1e-3, steps=6, finest=1e-5, tolerance=1e-5,
                                   outputs=["tip.x=beam.tip.position.x", "tip.z=beam.tip.position.z"],
                                   columns=["1x", "1z"]),
}


def cpu():
    u = resource.getrusage(resource.RUSAGE_CHILDREN)
    return u.ru_utime + u.ru_stime


def run(command, cwd):
    before = cpu()
    done = subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=900)
    return cpu() - before, done


def mbdyn_motion(mbdyn, p, step, method, folder, times_only=False, tolerance=1e-8):
    m = p["make"]()
    every = p["duration"] / p["samples"]
    per = max(1, round(every / step))
    step = every / per
    with open(os.path.join(folder, "m.mbd"), "w") as f:
        f.write(m.text(p["duration"], step, method, tolerance))
    cost, done = run([mbdyn, "-s", "-f", "m.mbd", "-o", "out"], folder)
    if done.returncode != 0:
        sys.stderr.write(done.stdout.decode()[-600:] + "\n")
        return cost, None
    rows, shown = [], m.shown
    with open(os.path.join(folder, "out.mov")) as f:
        lines = f.read().split("\n")
    k = len(shown)
    groups = [lines[i:i + k] for i in range(0, len(lines) - k + 1, k)]
    for i in range(per, per * p["samples"] + 1, per):  # the first group is the start
        at = {int(l.split()[0]): [float(x) for x in l.split()[1:4]] for l in groups[i]}
        rows.append([at[shown[int(c[0]) - 1]]["xyz".index(c[1])] for c in p["columns"]])
    return cost, rows



def cotree_motion(cotree, p, name, tolerance, method, folder):
    with open(os.path.join(ROOT, "systems", name, "model.yaml")) as f:
        text = f.read()
    text = text[:text.index("\noutputs:")] + "\noutputs:\n" + "".join(
        "  - {name: %s, value: %s}\n" % tuple(o.split("=", 1)) for o in p["outputs"])
    with open(os.path.join(folder, "model.yaml"), "w") as f:
        f.write(text)
    command = [cotree, "simulate", "model.yaml", "-q", "-o", "out.csv", "--until", repr(p["duration"]),
               "--samples", str(p["samples"] + 1), "--tolerance", repr(tolerance)]
    command += ["--method", method] if method else []
    for s in p["set"]:
        command += ["--set", s]
    cost, done = run(command, folder)
    if done.returncode != 0:
        sys.stderr.write(done.stdout.decode()[-600:] + "\n")
        return cost, None
    with open(os.path.join(folder, "out.csv")) as f:
        rows = [[float(x) for x in line.split(",")][1:] for line in f.read().split("\n")[1:] if line]
    return cost, rows[1:]  # without the start


def distance(rows, reference):
    """Largest difference of an output over the run, in parts of its largest value."""
    worst = 0.0
    for k in range(len(reference[0])):
        size = max(abs(r[k]) for r in reference)
        worst = max(worst, max(abs(a[k] - b[k]) for a, b in zip(rows, reference)) / size)
    return worst


def cheapest(tries, reference, target):
    """The cheapest of (label, time, rows) with an error of at most target."""
    good = [(cost, label, distance(rows, reference)) for label, cost, rows in tries
            if rows and distance(rows, reference) <= target]
    return min(good) if good else None


def least_time(motion):
    """The smallest time of three runs that are short, and the rows."""
    cost, rows = motion()
    if rows and cost < 2:
        cost = min(cost, motion()[0], motion()[0])
    return cost, rows


def main():
    cotree, mbdyn = sys.argv[1:3]
    print("| problem | error | cotree [s] | tolerance | MBDyn [s] | method, step [s] | ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in sys.argv[3:] or PROBLEMS:
        p = PROBLEMS[name]
        with tempfile.TemporaryDirectory() as folder:
            ours = [("%.0e" % t, *least_time(lambda: cotree_motion(cotree, p, name, t, None, folder)))
                    for t in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)]
            our_reference = cotree_motion(cotree, p, name, 1e-9, None, folder)[1]
            theirs = []
            for method in p.get("methods", ("ms, 0.6", "hope, 0.6")):
                step = p["step"]
                for _ in range(p.get("steps", 7)):
                    theirs.append(("%s; %.3g" % (method, step), *least_time(
                        lambda: mbdyn_motion(mbdyn, p, step, method, folder, tolerance=p["tolerance"]))))
                    step /= 2
            their_reference = mbdyn_motion(mbdyn, p, p["finest"], p.get("reference_method", "ms, 0.6"), folder,
                                           tolerance=p["tolerance"])[1]
            for label, cost, rows in ours:
                sys.stderr.write("cotree %s %.3f s %s\n" % (label, cost, rows and distance(rows, our_reference)))
            for label, cost, rows in theirs:
                sys.stderr.write("MBDyn %s %.3f s %s\n" % (label, cost, rows and distance(rows, their_reference)))
            sys.stderr.write("apart %g\n" % distance(our_reference, their_reference))
            for target in TARGETS:
                a, b = cheapest(ours, our_reference, target), cheapest(theirs, their_reference, target)
                print("| `%s` | %g | %s | %s | %s | %s | %s |" % (
                    name, target, "%.3f" % a[0] if a else "-", a[1] if a else "-", "%.3f" % b[0] if b else "-",
                    b[1] if b else "-", "%.1f" % (b[0] / a[0]) if a and b else "-"))
            sys.stdout.flush()


if __name__ == "__main__":
    main()

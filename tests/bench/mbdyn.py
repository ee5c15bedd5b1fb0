#!/usr/bin/env python3
"""Time to a required error of flexible mechanisms, cotree against MBDyn, in one run on one machine.

    mbdyn.py COTREE MBDYN [PROBLEM...]     prints a table in Markdown
    mbdyn.py --check COTREE                only reads cotree's models and writes MBDyn's

Both programs solve the same mechanism with as many elements. Each is compared with itself at far
smaller steps, so that the error is that of time integration. How far the two converged motions are
apart, which is the difference of the beam models, goes to the standard error, with every run. Time
is the CPU time of the whole program, the smallest of three runs if it is below 1 s.
"""
import math
import os
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
TARGETS = (1e-3, 1e-4, 1e-6)
METHODS = ("ms, 0.6", "hope, 0.6", "crank nicolson")
REFERENCE_METHOD = "ms, 0.6"


# ---- MBDyn's input -------------------------------------------------------------------------------

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


EYE = turn("x", 0)


def transposed(M):
    return [[M[k][i] for k in range(3)] for i in range(3)]


def matrix(M):
    return "matr, " + ", ".join(row(r) for r in M)


class Model:
    """Nodes, bodies, beams, joints and forces of one input file. Joint axes are those of ground at
    the start."""

    def __init__(self, gravity=None):
        self.node, self.element, self.count, self.gravity = [], [], {}, gravity
        self.kind, self.body, self.shown = [], [], []

    def add(self, kind, text):
        self.count[kind] = self.count.get(kind, 0) + 1
        self.element.append("  %s;" % text.replace("LABEL", str(len(self.element) + 1)))

    def add_node(self, at, R, kind="dynamic"):
        self.node.append((at, R))
        self.kind.append(kind)
        self.body.append([])
        return len(self.node)

    def add_body(self, node, mass, at, J, R=EYE):
        """Mass, its centre and inertia about it (3), in axes turned by R from those of the node."""
        turned = product([[R[i][k] * J[k] for k in range(3)] for i in range(3)], transposed(R))
        self.body[node - 1].append((mass, times(R, at), turned))

    def add_bodies(self):
        """One body for what is attached to a node."""
        for node, parts in enumerate(self.body):
            if not parts:
                continue
            mass = sum(p[0] for p in parts)
            centre = [sum(p[0] * p[1][i] for p in parts) / mass for i in range(3)]
            J = [[0.0] * 3 for _ in range(3)]
            for m, at, own in parts:
                d = plus(at, centre, -1)
                for i in range(3):
                    for j in range(3):
                        J[i][j] += own[i][j] + m * ((i == j) * sum(x * x for x in d) - d[i] * d[j])
            self.add("rigid bodies", "body: LABEL, %d, %.17g, %s, sym, %s" % (
                node + 1, mass, row(centre), row(J[i][j] for i in range(3) for j in range(i, 3))))

    def law(self, stiffness, beta):
        """EA, GAy, GAz, GJ, EIy, EIz; damping proportional to them."""
        if beta:
            return "linear viscoelastic generic, diag, %s, proportional, %.17g" % (
                row(stiffness), beta)
        return "linear elastic generic, diag, " + row(stiffness)

    def add_beam3(self, at, R, length, n, stiffness, mass, rotary):
        """n elements of three nodes; mass and rotary inertia (3) a length. Nodes, base first."""
        place = lambda i: plus(at, times(R, [length * i / (2 * n), 0, 0]))
        nodes = [self.add_node(place(i), R) for i in range(2 * n + 1)]
        h = length / n
        cut = [h / 2 * (1 - 1 / math.sqrt(3)), h / 2 * (1 + 1 / math.sqrt(3))]
        for e in range(n):
            a = nodes[2 * e:2 * e + 3]
            for node, start, end, own in ((a[0], 0, cut[0], 0), (a[1], cut[0], cut[1], h / 2),
                                          (a[2], cut[1], h, h)):
                m, s = mass * (end - start), end - start
                J = [rotary[0] * s, rotary[1] * s + m * s * s / 12, rotary[2] * s + m * s * s / 12]
                self.add_body(node, m, [(start + end) / 2 - own, 0, 0], J)
            self.add("beams", "beam3: LABEL, %d, null, %d, null, %d, null, from nodes, %s, same, "
                     "same" % (*a, self.law(stiffness, 0)))
        return nodes

    def add_beam2(self, a, b, R, length, stiffness, mass, rotary, beta=0.0):
        """One element of two nodes along x of R, from node a to node b; inertia lumped there."""
        for node in (a, b):
            to_node = product(transposed(self.node[node - 1][1]), R)
            J = [x * length / 2 for x in rotary]
            self.add_body(node, mass * length / 2, [0, 0, 0], J, to_node)
        ends = ["%d, position, null, orientation, %s" % (
            k, matrix(product(transposed(self.node[k - 1][1]), R))) for k in (a, b)]
        self.add("beams", "beam2: LABEL, %s, %s, from nodes, %s" % (
            *ends, self.law(stiffness, beta)))

    def hinge(self, a, b, R):
        """Node b turns about axis 3 of R against node a (0: ground), at the place of b."""
        at, R_b = self.node[b - 1]
        of_b = "position, null, orientation, " + matrix(product(transposed(R_b), R))
        if a == 0:
            self.add("joints", "joint: LABEL, revolute pin, %d, %s, position, %s, orientation, %s" %
                     (b, of_b, row(at), matrix(R)))
            return
        at_a, R_a = self.node[a - 1]
        back = transposed(R_a)
        of_a = "position, %s, orientation, %s" % (
            row(times(back, plus(at, at_a, -1))), matrix(product(back, R)))
        self.add("joints", "joint: LABEL, revolute hinge, %d, %s, %d, %s" % (a, of_a, b, of_b))

    def hold(self, a, b, places, turns, axis=None, angle=None):
        """Places and turns of node b against a (0: ground) that are held, along the axes of ground
        at the start, or turned about an axis by a given angle."""
        state = lambda s: ", ".join("active" if c == "1" else "inactive" for c in s)
        at_b, R_b = self.node[b - 1]
        of_b = matrix(transposed(R_b))
        here = "position orientation, %s, rotation orientation, %s" % (of_b, of_b)
        turned = "single, %s, %s" % (row(axis), angle) if axis else "null"
        rows = "position constraint, %s, null, orientation constraint, %s, %s" % (
            state(places), state(turns), turned)
        if a == 0:
            of_ground = "position, %s, position orientation, eye, rotation orientation, eye" % (
                row(at_b))
            self.add("joints", "joint: LABEL, total pin joint, %d, position, null, %s, %s, %s" % (
                b, here, of_ground, rows))
            return
        at_a, R_a = self.node[a - 1]
        back = transposed(R_a)
        of_a = "position, %s, position orientation, %s, rotation orientation, %s" % (
            row(times(back, plus(at_b, at_a, -1))), matrix(back), matrix(back))
        self.add("joints", "joint: LABEL, total joint, %d, %s, %d, position, null, %s, %s" % (
            a, of_a, b, here, rows))

    def text(self, duration, step, every, method, tolerance):
        """The input file; output at the start and after each `every` steps."""
        self.add_bodies()
        count = sorted(self.count.items())
        head = ["begin: data; problem: initial value; end: data;", "begin: initial value;",
                "  initial time: 0; final time: %.17g; time step: %.17g;" % (duration, step),
                "  method: %s; tolerance: %g; max iterations: 40;" % (method, tolerance),
                "  derivatives tolerance: 1e-2; derivatives max iterations: 20;",
                "  derivatives coefficient: 1e-6; linear solver: naive, colamd; output: none;",
                "end: initial value;", "begin: control data;",
                "  output precision: 16; default output: none;",
                "  default orientation: orientation matrix;",
                "  output meter: meter, 0., forever, steps, %d;" % every,
                "  structural nodes: %d;" % len(self.node)]
        head += ["  %s: %d;" % (k, v) for k, v in count]
        head += ["  gravity;"] if self.gravity else []
        head += ["end: control data;", "begin: nodes;"]
        for i, (at, R) in enumerate(self.node):
            head.append("  structural: %d, %s, %s, %s, null, null, output, %s;" % (
                i + 1, self.kind[i], row(at), matrix(R), "yes" if i + 1 in self.shown else "no"))
        head += ["end: nodes;", "begin: elements;"] + self.element
        if self.gravity:
            g = math.sqrt(sum(x * x for x in self.gravity))
            down = row([x / g for x in self.gravity])
            head.append("  gravity: uniform, %s, const, %.17g;" % (down, g))
        return "\n".join(head + ["end: elements;", ""])


# ---- the problems --------------------------------------------------------------------------------

STIFF = 10.0  # shear stiffness over EA where the beam of cotree does not shear


def steps_at(times, values):
    """A drive that is constant between the times, and at each the mean of both sides, which keeps
    the order of a method."""
    narrow = 1e-9
    points = [(-1.0, values[0])]
    for t, before, after in zip(times, values, values[1:]):
        points += [(t - narrow, before), (t + narrow, after)]
    return "piecewise linear, %d, %s" % (len(points), ", ".join(row(p) for p in points))


def slider_crank():
    m = Model()
    A, I, rho = 7.854e-5, 4.909e-10, 2770
    law = lambda E: [E * A, STIFF * E * A, STIFF * E * A, E * I, E * I, E * I]
    rotary = [2 * rho * I, 0, 0]
    crank = m.add_beam3([0, 0, 0], EYE, 0.152, 5, law(1e9), rho * A, rotary)
    rod = m.add_beam3([0.152, 0, 0], EYE, 0.304, 2, law(5e7), rho * A, rotary)
    m.hinge(0, crank[0], EYE)
    m.hinge(crank[-1], rod[0], EYE)
    m.hold(0, rod[-1], "010", "000")
    m.add("forces", 'couple: LABEL, absolute, %d, 0., 0., 1., string, '
          '"(0.005*(Time < 0.7 - 1e-9) + 0.005*(Time < 0.7 + 1e-9))*(1 - exp(-Time/0.167))"' %
          crank[0])
    m.shown = [crank[-1], rod[2], rod[-1]]
    return m


def pendulum():
    m = Model([0, 0, -9.81])
    A, I, rho, E, G = 1e-4, 8e-10, 2700, 7e10, 2.7e10
    law = [E * A, STIFF * E * A, STIFF * E * A, 2 * G * I, E * I, E * I]
    beam = m.add_beam3([0, 0, 0], EYE, 1.0, 1, law, rho * A, [2 * rho * I, 0, 0])
    m.hinge(0, beam[0], turn("x", -math.pi / 2))
    m.add_body(beam[-1], 0.1, [0, 0, 0], [1e-12] * 3)
    m.shown = [beam[-1]]
    return m


def arm():
    """Sections: length and rise in inches, E and nu, area, I of both axes, mass and rotary inertia
    a length."""
    m = Model()
    inch, slug, psi = 0.0254, 14.593902937206364, 6894.757293168361
    upper = (2.22e7, 0.495, 28.84, 66.21, 66.21, 0.003162, 0.007259)
    lower = (2.22e7, 0.495, 23.59, 44.27, 44.27, 0.001794, 0.003367)
    parts = [(22.5396, 0, 1e7, 0.3, 26.27, 54.91, 45.81, 0.01601, 0.03346),
             (12.0, 0, 1e7, 0.3, 30.04, 71.81, 121, 0.01528, 0.03653)]
    parts += [(x, 0, *upper) for x in (50.2099, 50.2099, 50.21, 50.2099)]
    parts += [(50.2363, -6, *upper), (55.59, 6, *lower)]
    parts += [(55.59, 0, *lower) for _ in range(3)] + [(55.62, 0, *lower)]
    parts += [(18.0, 0, 1e7, 0.3, 9.53, 7.22, 7.22, 0.002685, 0.002035),
              (29.9556, 0, 1e7, 0.3, 14.7, 17.2, 17.2, 0.008762, 0.01025),
              (26.045, 0, 1e7, 0.3, 3.51, 9.7, 9.7, 0.009917, 0.02741)]
    at, last = [0.0, 0.0, 0.0], m.add_node([0, 0, 0], EYE)
    inertia = lambda J: [x * slug * inch**2 for x in J]
    m.add_body(last, 6397 * slug, [0, 0, 0], inertia((1044e6, 134e6, 1003.7e6)))
    nodes = [last]
    for run, rise, E, nu, A, Iy, Iz, mass, rotary in parts:
        at = plus(at, [run * inch, 0, rise * inch])
        node = m.add_node(at, EYE)
        EA, shear = E * psi * A * inch**2, 0.53 / (2 * (1 + nu))
        bend = E * psi * inch**4
        mass, J = mass * slug / inch, [x * rotary * slug * inch for x in (2, 1, 1)]
        law = [EA, EA * shear, EA * shear, bend * (Iy + Iz) / (2 * (1 + nu)), bend * Iy, bend * Iz]
        m.add_beam2(last, node, turn("y", -math.atan2(rise, run)), math.hypot(run, rise) * inch,
                    law, mass, J)
        nodes.append(node)
        last = node
    m.add_body(last, 665 * slug, [0, 0, 0], inertia((10.4e6, 10.4e6, 3.469e6)))
    m.hinge(0, 1, turn("x", -math.pi / 2))
    pulse = 57600 * slug * inch**2
    torque = steps_at([5, 10], [pulse, -pulse, 0])
    m.add("forces", "couple: LABEL, absolute, 1, 0., 1., 0., " + torque)
    m.shown = [nodes[0], nodes[8], nodes[-1]]
    return m


def manipulator():
    """Elements of two nodes whose shear stiffness makes bending cubic: 12 EI/h^2."""
    m = Model([0, -9.81, 0])
    A, I, rho, E = 0.005, 1.989e-6, 3000, 7e10
    hub = m.add_node([0, 0, 0], EYE, "static")
    n = 4
    h = 3.0 / n
    link = [m.add_node([0.5 + i * h, 0, 0], EYE) for i in range(n + 1)]
    shear, rotary = 12 * E * I / h**2, rho * A * h**2 / 12
    law, inertia = [E * A, shear, shear, E * I, E * I, E * I], [2 * rho * I, rotary, rotary]
    for a, b in zip(link, link[1:]):
        m.add_beam2(a, b, EYE, h, law, rho * A, inertia)
    m.add_body(link[-1], 30, [0, 0, 0], [1e-9] * 3)
    m.hold(0, hub, "111", "111", [0, 1, 0], "ramp, %.17g, 1., forever, 0." % math.pi)
    m.hold(hub, link[0], "111", "111", [0, 0, 1], "ramp, %.17g, 2., forever, 0." % (math.pi / 2))
    m.shown = [link[-1]]
    return m


def four_bar():
    m = Model()
    thick = [5.2992e7, 1.68803e7, 1.68803e7, 7.33488e2, 1.1305e3, 1.1305e3]
    thin = [1.3248e7, 4.22008e6, 4.22008e6, 4.5843e1, 7.0656e1, 7.0656e1]

    def bar(start, R, length, stiffness, mass):
        nodes = [m.add_node(plus(start, times(R, [length * i / 4, 0, 0])), R) for i in range(5)]
        for a, b in zip(nodes, nodes[1:]):
            m.add_beam2(a, b, R, length / 4, stiffness, mass, [1e-4, 5e-5, 5e-5], 2e-4)
        return nodes

    bar1 = bar([0, 0, 0], turn("y", -math.pi / 2), 0.12, thick, 2)
    bar2 = bar([0, 0, 0.12], EYE, 0.24, thick, 2)
    bar3 = bar([0.24, 0, 0.12], turn("y", math.pi / 2), 0.12, thin, 0.5)
    about_y = turn("x", -math.pi / 2)
    m.hold(0, bar1[0], "111", "111", [0, 1, 0],
           'string, "pi/6*(Time/10 - sin(2*pi*Time/10)/(2*pi))"')
    m.hinge(bar1[-1], bar2[0], about_y)
    m.hinge(bar2[-1], bar3[0], product(turn("z", math.pi / 36), about_y))
    m.hinge(0, bar3[-1], about_y)
    m.shown = [bar1[-1], bar2[-1]]
    return m


# make: MBDyn's model. set: parameters of cotree's. samples: output times of both. step: MBDyn's
# largest of `steps`, each half of the one before; finest: that of its reference. tolerance: of its
# residual. outputs, columns: the same quantities in both; of MBDyn x, y, z or an entry of the
# rotation of a node.
PROBLEMS = {
    "slider_crank_flexible": dict(
        label="5 and 2 elements", make=slider_crank, set=["n=5"], duration=1.6, samples=80,
        step=2e-3, steps=7, finest=1e-5, tolerance=1e-8,
        outputs=["big.x=crank.pin.position.x", "big.y=crank.pin.position.y",
                 "mid.x=rod.mid.position.x", "mid.y=rod.mid.position.y",
                 "end.x=rod.pin.position.x"],
        columns=["1x", "1y", "2x", "2y", "3x"]),
    "pendulum_beam_tip_mass": dict(
        label="1 element", make=pendulum, set=[], duration=2.0, samples=100,
        step=2e-3, steps=7, finest=5e-6, tolerance=1e-5,
        outputs=["tip.x=beam.tip.position.x", "tip.z=beam.tip.position.z"], columns=["1x", "1z"]),
    "rms_arm": dict(
        label="15 elements", make=arm, set=[], duration=60.0, samples=120,
        step=0.25, steps=9, finest=2e-4, tolerance=1e-3,
        outputs=["phi=orbiter.rotation.xz", "elbow=fore.end.position.z", "z=payload.position.z",
                 "turn=payload.rotation.xz"],
        columns=["1xz", "2z", "3z", "3xz"]),
    "flexible_manipulator": dict(
        label="4 elements", make=manipulator, set=["n=4"], duration=3.0, samples=150,
        step=2e-3, steps=7, finest=8e-6, tolerance=1e-3,
        outputs=["x=link.tip.position.x", "y=link.tip.position.y", "z=link.tip.position.z"],
        columns=["1x", "1y", "1z"]),
    "flexible_four_bar": dict(
        label="12 elements", make=four_bar, set=[], duration=120.0, samples=120,
        step=1.0, steps=8, finest=1e-3, tolerance=1e-4,
        outputs=["B.x=bar1.end.position.x", "B.y=bar1.end.position.y", "B.z=bar1.end.position.z",
                 "C.x=bar2.end.position.x", "C.y=bar2.end.position.y", "C.z=bar2.end.position.z"],
        columns=["1x", "1y", "1z", "2x", "2y", "2z"]),
}


def cpu():
    u = resource.getrusage(resource.RUSAGE_CHILDREN)
    return u.ru_utime + u.ru_stime


def run(command, cwd):
    before = cpu()
    done = subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          timeout=900)
    if done.returncode != 0:
        sys.stderr.write(done.stdout.decode()[-600:] + "\n")
    return cpu() - before, done.returncode == 0


def mbdyn_motion(mbdyn, p, step, method, folder):
    """CPU time, and the outputs at the times after the start; none if the run failed."""
    m = p["make"]()
    between = p["duration"] / p["samples"]
    every = max(1, round(between / step))
    with open(os.path.join(folder, "m.mbd"), "w") as f:
        f.write(m.text(p["duration"], between / every, every, method, p["tolerance"]))
    cost, done = run([mbdyn, "-s", "-f", "m.mbd", "-o", "out"], folder)
    if not done:
        return cost, None
    with open(os.path.join(folder, "out.mov")) as f:
        lines = [line.split() for line in f]
    entry = {axis: 1 + i for i, axis in enumerate("xyz")}
    entry.update({a + b: 4 + 3 * i + j for i, a in enumerate("xyz") for j, b in enumerate("xyz")})
    n = len(m.shown)
    rows = [[float(lines[i + int(c[0]) - 1][entry[c[1:]]]) for c in p["columns"]]
            for i in range(n, len(lines), n)]
    return cost, rows if len(rows) == p["samples"] else None


def cotree_model(p, name):
    """The system with the outputs of the comparison."""
    with open(os.path.join(ROOT, "systems", name, "model.yaml")) as f:
        text = f.read()
    outputs = "".join("  - {name: %s, value: %s}\n" % tuple(o.split("=", 1)) for o in p["outputs"])
    before, after = text.split("\noutputs:", 1)
    return before + "\noutputs:\n" + outputs + after[after.index("\nsimulation:"):]


def cotree_motion(cotree, p, name, tolerance, method, folder):
    with open(os.path.join(folder, "model.yaml"), "w") as f:
        f.write(cotree_model(p, name))
    command = [cotree, "simulate", "model.yaml", "-q", "-o", "out.csv",
               "--until", repr(p["duration"]), "--samples", str(p["samples"] + 1),
               "--tolerance", repr(tolerance), "--method", method]
    for s in p["set"]:
        command += ["--set", s]
    cost, done = run(command, folder)
    if not done:
        return cost, None
    with open(os.path.join(folder, "out.csv")) as f:
        lines = f.read().split("\n")[1:]
    rows = [[float(x) for x in line.split(",")][1:] for line in lines if line]
    return cost, rows[1:]  # without the start


def distance(rows, reference):
    """Largest difference of an output over the run, in parts of its largest value."""
    worst = 0.0
    for k in range(len(reference[0])):
        size = max(abs(r[k]) for r in reference)
        worst = max(worst, max(abs(a[k] - b[k]) for a, b in zip(rows, reference)) / size)
    return worst


def cheapest(tries, target):
    """The cheapest of (label, time, error) with an error of at most target."""
    good = [(cost, label) for label, cost, error in tries if error is not None and error <= target]
    return min(good) if good else None


def least_time(motion):
    """The smallest time of three runs that are short, and the rows."""
    cost, rows = motion()
    if rows and cost < 1:
        cost = min(cost, motion()[0], motion()[0])
    return cost, rows


def tried(program, motions, reference):
    """(label, time, error) of each motion."""
    tries = []
    for label, motion in motions:
        cost, rows = least_time(motion)
        tries.append((label, cost, distance(rows, reference) if rows else None))
        sys.stderr.write("%s %s: %.3f s, error %s\n" % (program, *tries[-1]))
    return tries


def compare(cotree, mbdyn, name, folder):
    p = PROBLEMS[name]
    ours = lambda tolerance, method: lambda: cotree_motion(
        cotree, p, name, tolerance, method, folder)
    theirs = lambda step, method: lambda: mbdyn_motion(mbdyn, p, step, method, folder)
    our_reference = ours(1e-9, "auto")()[1]
    their_reference = theirs(p["finest"], REFERENCE_METHOD)()[1]
    sys.stderr.write("%s: converged motions apart %.2g; reference of cotree against 1e-8 %.1g, of "
                     "MBDyn against twice its step %.1g\n" % (
                         name, distance(their_reference, our_reference),
                         distance(ours(1e-8, "auto")()[1], our_reference),
                         distance(theirs(2 * p["finest"], REFERENCE_METHOD)()[1], their_reference)))
    a = tried("cotree", [("%s, %.0e" % (method, 10.0**-k), ours(10.0**-k, method))
                         for method in ("auto", "radau5") for k in range(2, 8)], our_reference)
    b = tried("MBDyn", [("%s; %.3g" % (method, p["step"] / 2**k), theirs(p["step"] / 2**k, method))
                        for method in METHODS for k in range(p["steps"])], their_reference)
    for target in TARGETS:
        x, y = cheapest(a, target), cheapest(b, target)
        ratio = "%.2g" % (y[0] / x[0]) if x and y else "-"
        times_of = ["%.3f | %s" % best if best else "- | -" for best in (x, y)]
        print("| `%s`, %s | %g | %s | %s |" % (
            name, p["label"], target, " | ".join(times_of), ratio))
    sys.stdout.flush()


def check(cotree, name, folder):
    p = PROBLEMS[name]
    with open(os.path.join(folder, "model.yaml"), "w") as f:
        f.write(cotree_model(p, name))
    settings = [word for s in p["set"] for word in ("--set", s)]
    good = run([cotree, "check", "model.yaml", *settings], folder)[1]
    model = p["make"]()
    model.text(p["duration"], p["step"], 1, METHODS[0], p["tolerance"])
    shown = all(int(c[0]) <= len(model.shown) for c in p["columns"])
    return good and shown and len(p["columns"]) == len(p["outputs"])


def main():
    if sys.argv[1] == "--check":
        with tempfile.TemporaryDirectory() as folder:
            cotree = os.path.abspath(sys.argv[2])
            bad = [name for name in PROBLEMS if not check(cotree, name, folder)]
        sys.exit("wrong: " + ", ".join(bad) if bad else 0)
    cotree, mbdyn = [os.path.abspath(program) for program in sys.argv[1:3]]
    print("| problem | error | cotree [s] | method, tolerance | MBDyn [s] | method; step [s] | "
          "ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in sys.argv[3:] or PROBLEMS:
        with tempfile.TemporaryDirectory() as folder:
            compare(cotree, mbdyn, name, folder)


if __name__ == "__main__":
    main()

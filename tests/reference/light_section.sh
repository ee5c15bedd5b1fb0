#!/bin/sh
# light_section.sh: a lumped beam in free flight whose frame sits on a section a hundred thousand times lighter than what turns with it.
# Solving for its acceleration leaves some 1e-10 of it, more than a step may err by at 1e-11, however short: 393 921 steps for 172.
# The reference is a program of 64 binary digits with Lagrange's equations of the same nodes.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/model.yaml" <<'END'
cotree: 1
bodies:
  rod:
    type: beam
    length: 1.5
    elements: 2
    E: 2e9
    density: 1500
    area: 3e-4
    Iz: 6e-9
    mass: lumped
    rotary_inertia: [1e-5, 1e-5, 1e-5]
    formulation: linear
    deformation: [axial, bending-z]
    initial: {v: "0.03*(x/length)^2", rates: {v: "0.3*(x/length)^2"}}
    points: {tip: 1.5}
  knob: {mass: 0.2, inertia: 2e-3, com: [0.02, 0.01, 0]}
joints:
  f: {type: planar, from: ground, to: rod, initial: {q: [0.1, 0.2, 0.3], u: [0.3, 0.2, 3]}}
  w: {type: weld, from: rod.tip, to: knob}
outputs: [f.q3, f.u3, rod.tip.deflection.y, rod.tip.slope.z]
simulation: {duration: 0.002, samples: 2, tolerance: 1e-11}
END
"$COTREE" simulate "$work/model.yaml" --quiet -o "$work/result.csv" --summary "$work/summary.json" 2>/dev/null
steps=$(sed -n 's/^ *"steps": \([0-9]*\),$/\1/p' "$work/summary.json")
awk -F, -v steps="$steps" '
    function miss(got, want, of) { d = got > want ? got - want : want - got; return d / of }
    NR == 3 {
        worst = miss($2, 0.31007562299630339953, 0.3)
        if ((e = miss($3, 3.1919364709958062745, 3)) > worst) worst = e
        if ((e = miss($4, 0.024492501693070630742, 0.03)) > worst) worst = e
        if ((e = miss($5, 0.036365331414841549784, 0.04)) > worst) worst = e
        printf "%d steps, error %.2g\n", steps, worst
        exit !(steps < 2000 && worst < 1e-8)
    }' "$work/result.csv"

#!/bin/sh
# thrown_beam.sh: a free timoshenko beam in space, thrown with a spin. It hardly bends, 2e-8 m, while shear of its sections could vibrate at
# 2e5 rad/s; the total energy is an output, and for it such vibrations need not be followed (563 207 steps with reduced integration if they
# are). The reference is a rigid body with the beam's mass and the inertia of its sections, Euler's equations in steps of 5e-5 s.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for rule in reduced full; do
    cat >"$work/model.yaml" <<END
cotree: 1
bodies:
  rod:
    type: beam
    theory: timoshenko
    integration: $rule
    length: 2
    elements: 4
    density: 7850
    E: 2.1e11
    G: 8.1e10
    area: 4e-3
    Iz: 0.05*0.08^3/12
    Iy: 0.08*0.05^3/12
    shear_factor: 5/6
    rotary_inertia: true
    deformation: [bending-y, bending-z]
    points: {tip: length}
joints:
  fly: {type: free, from: ground, to: rod, initial: {u: [1, 0.5, 3, 0.3, 0.2, 4]}}
outputs: [rod.tip.position, system.angular_momentum, energy.total]
simulation: {duration: 1, samples: 2, tolerance: 1e-8}
END
    "$COTREE" simulate "$work/model.yaml" --quiet -o "$work/result.csv" --summary "$work/summary.json" 2>/dev/null
    steps=$(sed -n 's/^ *"steps": \([0-9]*\),$/\1/p' "$work/summary.json")
    awk -F, -v steps="$steps" -v rule="$rule" '
        function miss(got, want, of) { d = (got - want) / of; if (d < 0) d = -d; if (d > worst) worst = d }
        NR == 3 {
            miss($2, 1.35016539673, 1); miss($3, 3.74086718684, 1); miss($4, 2.83784653723, 1)
            miss($5, 0.013973, 400); miss($6, -171.650717, 400); miss($7, 366.467307, 400)
            bent = worst
            worst = 0
            miss($8, 1081.5816376166665, 1081.6)
            printf "%s: %d steps, off by %.2g, energy by %.2g\n", rule, steps, bent, worst
            exit !(steps < 30000 && bent < 5e-8 && worst < 1e-8)
        }' "$work/result.csv"
done

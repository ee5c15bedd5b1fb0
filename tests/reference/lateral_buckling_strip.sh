#!/bin/sh
# lateral_buckling_strip.sh: a clamped strip on its own says out of which plane it buckles, what twists it and how it vibrates, although
# nothing in the model pushes it there. COTREE is the program.
#   - across its tip, in the plane of its large stiffness: Prandtl's load P L^2 = x sqrt(EIy GJ), u(x) = 0 with
#     u = 1 - z/(3 4) + z^2/(3 4 7 8) - ..., z = x^2 (Timoshenko and Gere, Theory of Elastic Stability, 6.3). Errors fall with
#     the square of the number of elements; what extrapolation leaves are EIy/EIz and GJ/EIz, 2.5e-5 together
#   - at P and a side load W << P its tip twists by W/P (1/u - 1)
#   - the same with lumped masses, which leave twist and rotations without inertia
#   - along its axis: Euler's load about the axis of the smaller stiffness
#   - frequencies of bending about both axes and of twist; those of N linear elements in twist are known exactly,
#     those of quadratic ones are off by (k h)^4/1440
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
model() { # ELEMENTS FORCE
    cat <<END
cotree: 1
bodies:
  strip: {type: beam, length: 2, elements: $1, density: 2700, E: 7e10, nu: 0.3, area: 1e-3, Iz: 1e-4, Iy: 1e-9, J: 4e-9, formulation: foreshortening, points: {tip: length}}
joints:
  clamp: {type: weld, from: ground, to: strip}
forces:
  push: {type: force, at: strip.tip, value: [$2]}
outputs: [strip.tip.slope.x]
simulation: {duration: 1}
END
}
for n in 8 16; do
    model $n '0, 1, 0' >across.yaml
    "$COTREE" buckling across.yaml --load push --count 1 -q | awk -F, -v n=$n 'NR == 2 { print "prandtl", n, $2 }'
    model $n '0, 60, 5e-4' >side.yaml
    "$COTREE" equilibrium side.yaml -q | awk -F, -v n=$n 'NR == 2 { print "twist", n, $2 }'
done >found
model 16 '0, 1, 0' | sed 's/type: beam,/type: beam, mass: lumped,/' >lumped.yaml
"$COTREE" buckling lumped.yaml --load push --count 1 -q | awk -F, 'NR == 2 { print "lumped", 16, $2 }' >>found
model 8 '-1, 0, 0' >along.yaml
"$COTREE" buckling along.yaml --load push --count 1 -q | awk -F, 'NR == 2 { print "euler", 8, $2 }' >>found
"$COTREE" modes along.yaml --count 4 -q | awk -F, 'NR > 1 { print "mode" NR - 1, 8, $3 }' >>found
sed 's/type: beam,/type: beam, twist: quadratic,/' along.yaml >quadratic.yaml
"$COTREE" modes quadratic.yaml --count 4 -q | awk -F, 'NR > 1 { print "quadratic" NR - 1, 8, $3 }' >>found
awk '
    function u(z, n, t, sum) {
        sum = t = 1
        n = 0
        while (t * t > 1e-34) { n += 4; t *= -z / (n * (n - 1)); sum += t }
        return sum
    }
    function check(what, got, want, allowed, off) {
        off = got / want - 1
        printf "%s: %.8g, wanted %.8g, off by %.1e\n", what, got, want, off
        nchecked++
        if (!(off * off < allowed * allowed)) failed = 1
    }
    { value[$1, $2] = $3 }
    END {
        pi = atan2(0, -1); L = 2; E = 7e10; EIy = 70; GJ = E / 2.6 * 4e-9; m = 2.7
        low = 1; high = 20
        while (high - low > 1e-12) { z = (low + high) / 2; if (u(z) > 0) low = z; else high = z }
        load = sqrt(low * EIy * GJ) / L^2
        coarse = value["prandtl", 8] / load - 1; fine = value["prandtl", 16] / load - 1
        printf "8 and 16 elements: off by %.2e, %.2e\n", coarse, fine
        if (!(coarse > 3.8 * fine && coarse < 4.2 * fine)) failed = 1
        check("load across", (4 * value["prandtl", 16] - value["prandtl", 8]) / 3, load, 1e-4)
        check("whatever its masses", value["lumped", 16], value["prandtl", 16], 1e-10)
        twist = 5e-4 / 60 * (1 / u(60^2 * L^4 / (EIy * GJ)) - 1)
        check("twist", -(4 * value["twist", 16] - value["twist", 8]) / 3, twist, 1e-4)
        check("load along", value["euler", 8], pi^2 * EIy / (4 * L^2), 1e-5)
        w = sqrt(EIy / m) / L^2
        check("bending 1", value["mode1", 8], 3.5160152685 * w, 1e-4)
        check("bending 2", value["mode3", 8], 22.034491565 * w, 1e-3)
        c2 = GJ / (2700 * (1e-4 + 1e-9)); h = L / 8
        check("twist 1", value["mode2", 8], sqrt(6 * c2 / h^2 * (1 - cos(pi / 16)) / (2 + cos(pi / 16))), 1e-9)
        check("quadratic", value["quadratic2", 8], sqrt(c2) * pi / 4 * (1 + (pi / 16)^4 / 1440), 1e-8)
        exit failed || nchecked != 8
    }' found || { cat found; exit 1; }

#!/bin/sh
# deformed_start.sh: beams that start deformed and moving, against the waves of the uniform beam. COTREE is the program.
#
# A supported beam (frame: chord), in two planes: v = a cos(w t) sin(k x), w = k^2 sqrt(EI/m); a clamped one along its axis and in
# torsion: c cos(w t) sin(k x), k = pi/(2 L), w = k sqrt(EA/m), k sqrt(G J/j). With a rate b in place of a it is b/w sin(w t).
# Frequencies of elements of length h are off by (k h)^4/1440, which is w t times that in the phase; what of the start is in other
# modes is of order (k h)^4/720, the error of its strain energy. `shapes` and `modes` that contain the start agree with it alike.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

while IFS='|' read -r name bridge strip shaft; do
  cat >"$work/start.yaml" <<END
cotree: 1
parameters: {a: 1e-5, b: 2e-4, c: 1e-4}
bodies:
  bridge: {type: beam, length: 2, elements: 16, mass_per_length: 3, E: 1e7, area: 1e-2, Iz: 1e-6, frame: chord, formulation: linear,
    deformation: [bending-z], points: {mid: length/2, quarter: length/4, end: length}, $bridge
    initial: {v: "a*sin(pi*x/length)", rates: {v: "b*sin(2*pi*x/length)"}}}
  strip: {type: beam, length: 2, elements: 16, mass_per_length: 3, E: 1e7, area: 1e-2, Iy: 4e-6, frame: chord, formulation: linear,
    deformation: [bending-y], points: {mid: length/2, end: length}, $strip
    initial: {w: "a*sin(pi*x/length)"}}
  shaft: {type: beam, length: 1, elements: 8, mass_per_length: 3, E: 1e4, G: 4e3, area: 1e-2, Iz: 1e-2, J: 1e-2, twist: quadratic,
    rotary_inertia: [0.02, 0.01, 0.01], stretch: quadratic, formulation: linear, deformation: [axial, torsion], points: {end: length}, $shaft
    initial: {u: "c*sin(pi*x/(2*length))", rates: {rx: "c*sin(pi*x/(2*length))"}}}
joints:
  post1: {type: revolute, from: ground, to: bridge, axis: z, initial: {q: 0, guess: true}}
  rest1: {type: custom, from: ground, to: bridge.end, coordinates: [s, p], translate: [s, 0, 0], rotate: [[z, p]], initial: {q: [2, 0], guess: true}}
  post2: {type: revolute, from: ground, to: strip, axis: y, initial: {q: 0, guess: true}}
  rest2: {type: custom, from: ground, to: strip.end, coordinates: [s, p], translate: [s, 0, 0], rotate: [[y, p]], initial: {q: [2, 0], guess: true}}
  clamp: {type: weld, from: ground, to: shaft}
outputs: [bridge.mid.deflection.y, strip.mid.deflection.z, bridge.quarter.deflection.y, shaft.end.deflection.x, shaft.end.slope.x]
simulation: {duration: 2, interval: 0.1, method: dop853, tolerance: 1e-10}
END
  "$COTREE" simulate "$work/start.yaml" -q -o "$work/start.csv"
  awk -F, -v name="$name" '
    # size times what the phase w t is off by, and what is in other modes, of waves of k h
    function check(what, got, wanted, size, phase, kh) {
        off = got - wanted; off = off < 0 ? -off : off
        off /= size * (phase * kh^4 / 1440 + kh^4 / 720)
        if (off > most) { most = off; worst = what " at " $1 " s" }
    }
    BEGIN { pi = atan2(0, -1); a = 1e-5; b = 2e-4; c = 1e-4 }
    NR > 1 {
        t = $1; k = pi / 2; w = k^2 * sqrt(10 / 3)
        check("v", $2, a * cos(w * t), a, w * t, pi / 16)
        check("w", $3, a * cos(2 * w * t), a, 2 * w * t, pi / 16)
        rest = $4 - a * sqrt(0.5) * cos(w * t)
        check("rate of v", rest, b / (4 * w) * sin(4 * w * t), b / (4 * w), 4 * w * t, 2 * pi / 16)
        w = k * sqrt(1e2 / 3)
        check("u", $5, c * cos(w * t), c, w * t, pi / 16)
        w = k * sqrt(4e1 / 0.02)
        check("rate of rx", $6, c / w * sin(w * t), c / w, w * t, pi / 16)
    }
    END {
        if (NR != 22) { print name ": no result"; exit 1 }
        printf "%s: at most %.2f of the bound (%s)\n", name, most, worst
        exit !(most < 1)
    }' "$work/start.csv" || failed=1
done <<'END'
nodes|||
shapes|shapes: {v: ["sin(pi*x/length)", "sin(2*pi*x/length)"]},|shapes: {w: "sin(pi*x/length)"},|shapes: {u: "sin(pi*x/(2*length))", rx: "sin(pi*x/(2*length))"},
modes|modes: 10,|modes: 10,|modes: 6,
END
exit "$failed"

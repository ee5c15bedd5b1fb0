#!/bin/sh
# beams_more.sh CASE: beams against closed forms and independent programs (Ritz, transfer matrices, shooting). COTREE is the program.
#   axis       E, density, area and Iz are polynomials of x: three frequencies and static deflections; errors fall with the
#              fourth power of the element's length
#   jump       Iz and mass per length jump inside an element: the tip is right to round-off with any number of elements
#   arm        a strip that an eccentric end force bends about its weak axis and twists
#   weak       one that is bent about its weak axis, or in its plane, does not buckle
#   sideways   a cantilever under an end force across, cut into 4 and 8 beams: Kirchhoff rods with the bending before; the first
#              factor is the same however many are asked for, with sparse matrices, too
#   steady     quadratic_velocity: false, on a driven hub, in a loop on two trees, and in space
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failed=0

# near WHAT GOT WANTED TOLERANCE (relative)
near() {
    awk -v what="$1" -v got="$2" -v want="$3" -v tolerance="$4" 'BEGIN {
        d = got / want - 1
        printf "%s: %.10g, wanted %.10g, off by %.1e\n", what, got, want, d
        exit !(got != "" && d < tolerance && d > -tolerance) }' || failed=1
}

# beam LENGTH ELEMENTS FORCE REST: a cantilever
beam() {
    cat <<END
cotree: 1
bodies:
  s: {type: beam, length: $1, elements: $2, points: {tip: length, arm: [length, 0.25, 0]}, $4}
joints:
  clamp: {type: weld, from: ground, to: s}
forces:
  push: {type: force, at: s.tip, value: [$3]}
outputs: [s.tip.deflection.x, s.tip.deflection.y, s.tip.deflection.z]
END
}

omega() { "$COTREE" modes "$1" --count "$2" -q | tail -n 1 | cut -d, -f3; }
tip() { "$COTREE" equilibrium "$1" -q 2>said | tail -n 1 | cut -d, -f"$2"; }
factor() { "$COTREE" buckling "$1" --load push --count "$2" -q | sed -n 2p | cut -d, -f2; }

strip='mass_per_length: 1, E: 1e7, G: 1e7, area: 0.84, Iy: 2.8e-7, Iz: 2.8e-5, J: 4e-7, formulation: foreshortening'

case $1 in
axis)
    polynomials='E: "7e10*(1 + 0.5*(x/length)^2)", density: "2700*(1 - 0.3*x/length)", area: "6e-4*(1 - 0.4*x/length)",
    Iz: "5e-9*(1 - 0.4*x/length)^3", formulation: linear, deformation: [bending-z]'
    beam 2 16 '0, 20, 0' "$polynomials" >16.yaml
    near 'tip' "$(tip 16.yaml 3)" 0.206660278923 1e-6
    near 'omega 1' "$(omega 16.yaml 1)" 16.0507232312 1e-6
    near 'omega 2' "$(omega 16.yaml 2)" 82.2659889113 1e-5
    near 'omega 3' "$(omega 16.yaml 3)" 217.358928377 1e-4
    beam 2 32 '0, 20, 0' "$polynomials" >32.yaml
    coarse=$(omega 16.yaml 3)
    near 'omega 3, extrapolated' "$(omega 32.yaml 3 | awk -v c="$coarse" '{ printf "%.17g", $1 + ($1 - c) / 15 }')" 217.358928377 2e-6
    sed '/^forces/,/push/d' 16.yaml | sed 's/^cotree: 1/&\ngravity: [0, -9.81, 0]/' >weight.yaml
    near 'under its weight' "$(tip weight.yaml 3)" -0.0637389435477 1e-6
    ;;
jump)
    for n in 1 3 8 32; do
        beam 3 $n '0, 10, 0' 'E: 7e10, mass_per_length: "if(x < 1.3, 1.4, 0.9)", Iz: "if(1.3 - x > 0, 8e-9, 3e-9)", formulation: linear,
    deformation: [bending-z]' >$n.yaml
        near "tip, $n elements" "$(tip $n.yaml 3)" 0.209454365079 1e-11
    done
    near 'omega 1' "$(omega 32.yaml 1)" 9.03069588795 1e-7
    near 'omega 2' "$(omega 32.yaml 2)" 42.3021264052 1e-6
    near 'omega 3' "$(omega 32.yaml 3)" 118.892267153 1e-5
    # the material, by a root of higher degree, in a list of ends; abs, max and sign have kinks and jumps there
    beam 3 '[1, 3]' '0, 10, 0' 'E: "if(x^2 < 1.69, 8e10, 3e10)", Iz: 7e-9, mass_per_length: "1.15 - 0.25*sign(x - 1.3)",
    formulation: linear, deformation: [bending-z]' >list.yaml
    near 'tip, jump of E' "$(tip list.yaml 3)" 0.209454365079 1e-11
    "$COTREE" check list.yaml 2>&1 | grep -q 'x = 1.3 m), 3 in all' || { echo 'check does not say where elements end'; failed=1; }
    # what switches everywhere is said
    beam 3 2 '0, 10, 0' 'E: 7e10, mass_per_length: 1, Iz: "if(sin(1e4*x) > 0, 8e-9, 3e-9)", formulation: linear' >comb.yaml
    "$COTREE" check comb.yaml 2>&1 | grep -q "where 'Iz' switches along the beam cannot be told" || { echo 'a comb is not told'; failed=1; }
    ;;
arm)
    while read -r load x y z tolerance; do
        beam 1 8 "0, 0, -$load" "$strip" | sed 's/at: s.tip/at: s.arm/' >arm.yaml
        scale=$(echo "$z" | tr -d -)
        for at in "2 $x" "3 $y" "4 $z"; do
            awk -v got="$(tip arm.yaml "${at% *}")" -v want="${at#* }" -v scale="$scale" -v tolerance="$tolerance" -v load="$load" 'BEGIN {
                d = (got - want) / scale
                printf "%g N: %.8g, wanted %.8g, off by %.1e\n", load, got, want, d
                exit !(got != "" && d < tolerance && d > -tolerance) }' || failed=1
        done
    done <<'END'
0.4 -0.001354190866 -0.0002997007822 -0.04748881078 3e-3
1 -0.008262988316 -0.001831379223 -0.1170668162 2e-2
2 -0.03054443223 -0.006801759296 -0.2235918167 6e-2
END
    ;;
weak)
    beam 1 8 '0, 0, 1' "$strip" >weak.yaml
    for area in 0.84 0.0084 8.4e-4; do
        beam 1 8 '0, 1, 0' "mass_per_length: 1, E: 1e7, area: $area, Iz: 2.8e-7, formulation: foreshortening" >plane_$area.yaml
    done
    for model in weak plane_0.84 plane_0.0084 plane_8.4e-4; do
        for count in 1 3; do
            ! "$COTREE" buckling $model.yaml --load push --count $count -q >found 2>said || { echo "$model buckles"; cat found; failed=1; }
            grep -q 'does not lead to buckling.*E414' said || { cat said; failed=1; }
        done
    done
    ;;
sideways)
    # chain NBEAM ELEMENTS Iz
    chain() {
        awk -v K="$1" -v n="$2" -v Iz="$3" 'BEGIN {
        print "cotree: 1\nbodies:"
        for (i = 1; i <= K; i++)
            printf "  b%d: {type: beam, length: 1/%d, elements: %d, mass_per_length: 1, E: 1e7, G: 1e7, area: 0.84, Iz: %s, Iy: 2.8e-7," \
                " J: 4e-7, formulation: foreshortening, points: {end: length}}\n", i, K, n / K, Iz
        print "joints:\n  j1: {type: weld, from: ground, to: b1}"
        for (i = 2; i <= K; i++)
            printf "  j%d: {type: weld, from: b%d.end, to: b%d}\n", i, i - 1, i
        printf "forces: {push: {type: force, at: b%d.end, value: [0, 1, 0]}}\n", K }'
    }
    for n in 4 8; do
        chain $n 16 2.8e-6 >$n.yaml
        factor $n.yaml 1 >$n
    done
    near 'Iz = 10 Iy' "$(awk -v c="$(cat 4)" '{ printf "%.17g", $1 + ($1 - c) / 3 }' 8)" 16.16734673 5e-3
    chain 1 8 2.8e-5 >one.yaml
    factor one.yaml 1 >8
    chain 1 16 2.8e-5 >one.yaml
    factor one.yaml 1 >16
    near 'Iz = 100 Iy' "$(awk -v c="$(cat 8)" '{ printf "%.17g", $1 + ($1 - c) / 3 }' 16)" 13.62511317 3e-3
    chain 1 52 2.8e-5 >large.yaml # more than 300 speeds: sparse matrices first
    near '312 speeds' "$(factor large.yaml 1)" 13.62511317 3e-3
    near 'two asked for' "$(factor one.yaml 2)" "$(cat 16)" 1e-9
    ;;
steady)
    cat >spin.yaml <<'END'
cotree: 1
bodies:
  beam: {type: beam, elements: 5, formulation: linear, quadratic_velocity: false, length: 10, density: 3000, E: 7e10, area: 4e-4, Iz: 2e-7,
    points: {tip: length}}
joints:
  hub: {type: revolute, from: ground, to: beam, motion: "6*(t^2/(2*15) + 15/(4*pi^2)*(cos(2*pi*t/15) - 1))"}
outputs: [beam.tip.deflection.y]
simulation: {duration: 10, interval: 2, method: radau5, tolerance: 1e-10}
END
    "$COTREE" simulate spin.yaml -q -o spin.csv 2>said
    while read -r t v; do
        near "spin-up, t = $t" "$(awk -F, -v t="$t" '$1 == t { print $2 }' spin.csv)" "$v" 1e-7
    done <<'END'
2 -0.1023811475
4 -0.3441653472
6 -0.5689718674
8 -0.6274920381
10 -0.4771064404
END
    sed 's/formulation: linear, //' spin.yaml >wrong.yaml
    ! "$COTREE" check wrong.yaml >said 2>&1 || failed=1
    grep -q "needs 'formulation: linear'" said || { cat said; failed=1; }
    cat >crank.yaml <<'END'
cotree: 1
bodies:
  crank: {type: beam, length: 0.152, elements: 1, density: 2770, E: 1e9, area: 7.854e-5, Iz: 4.909e-10, formulation: linear,
    quadratic_velocity: false, points: {pin: length}}
  rod: {type: beam, length: 0.304, elements: 2, density: 2770, E: 5e7, area: 7.854e-5, Iz: 4.909e-10, formulation: linear,
    quadratic_velocity: false, points: {mid: length/2, pin: length}}
  slider: {mass: 0}
joints:
  main: {type: revolute, from: ground, to: crank, effort: "if(t < 0.7, 0.01*(1 - exp(-t/0.167)), 0)", initial: {q: 0, u: 0}}
  big_end: {type: revolute, from: crank.pin, to: rod, initial: {q: 0, u: 0}}
  small_end: {type: revolute, from: rod.pin, to: slider, initial: {q: 0, guess: true}}
  guide: {type: prismatic, from: ground, to: slider, axis: x, initial: {q: 0.456, guess: true}}
outputs: [guide.q, rod.mid.chord_deflection.y]
simulation: {duration: 0.8, interval: 0.4, tolerance: 1e-9}
END
    for tree in joints absolute; do
        "$COTREE" simulate crank.yaml --tree $tree -q -o crank.csv 2>said
        near "slider, $tree" "$(tail -n 1 crank.csv | cut -d, -f2)" 0.226709270 2e-7
        near "rod, $tree" "$(tail -n 1 crank.csv | cut -d, -f3)" 8.7409789e-04 1e-5
    done
    cat >space.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  a: {type: beam, length: 1, elements: 12, mass_per_length: 1, E: 1e9, nu: 0.3, area: 1e-4, Iz: 1e-8, Iy: 2e-8, formulation: linear,
    quadratic_velocity: false, points: {end: length}}
  b: {type: beam, length: 1, elements: 12, mass_per_length: 1, E: 1e9, nu: 0.3, area: 1e-4, Iz: 1e-8, Iy: 2e-8, formulation: linear,
    quadratic_velocity: false, rotary_inertia: [1e-3,1e-3,1e-3], points: {end: length}}
joints:
  p: {type: spherical, from: ground, to: a, initial: {u: [1, 2, 3]}}
  q: {type: revolute, from: a.end, to: b, axis: [0, 1, 1], initial: {u: 2}}
outputs: [b.end.position.x, p.force.x]
simulation: {duration: 0.3, samples: 2, tolerance: 1e-9}
END
    # articulated bodies against constraints of free bodies
    for tree in joints absolute; do
        "$COTREE" simulate space.yaml --tree $tree -q -o $tree.csv 2>said
    done
    near 'in space, place' "$(tail -n 1 joints.csv | cut -d, -f2)" "$(tail -n 1 absolute.csv | cut -d, -f2)" 1e-8
    near 'in space, force' "$(tail -n 1 joints.csv | cut -d, -f3)" "$(tail -n 1 absolute.csv | cut -d, -f3)" 1e-7
    ;;
*)
    echo "beams_more.sh: no case $1" >&2
    exit 2
    ;;
esac
exit "$failed"

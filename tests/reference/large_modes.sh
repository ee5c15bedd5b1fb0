#!/bin/sh
# large_modes.sh: the first ten modes of cantilevers that are too large for full matrices, of one beam and of a chain of
# beams welded end to end, against the continuous beam: bending (k/L)^2 sqrt(EI/m), cosh k cos k = -1, torsion
# (2 j - 1) pi/(2 L) sqrt(G J/(m (Iy + Iz)/A)), stretch (2 j - 1) pi/(2 L) sqrt(E A/m).
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# beams NBEAM NELEMENT IZ
beams() {
  awk -v n="$1" -v elements="$2" -v Iz="$3" 'BEGIN {
    print "cotree: 1\nbodies:"
    for (i = 0; i < n; i++)
      printf "  b%d: {type: beam, length: 10/%d, elements: %d, mass_per_length: 1, E: 1e7, nu: 0.25, area: 1, Iy: 1/12," \
        " Iz: %s, J: 1/6, points: {tip: length}, deformation: [axial, bending-y, bending-z, torsion]}\n", i, n, elements, Iz
    print "joints:\n  j0: {type: weld, from: ground, to: b0}"
    for (i = 1; i < n; i++)
      printf "  j%d: {type: weld, from: b%d.tip, to: b%d}\n", i, i - 1, i
  }'
}

# exact IZ: what the continuous beam has
exact() {
  awk -v Iz="$1" 'BEGIN {
    split("1.8751040687119611 4.6940911329741745 7.8547574382376126 10.995540734875467 14.137168391046470", k, " ")
    pi = 3.14159265358979323846
    split("1/12 " Iz, I, " ")
    for (i = 1; i <= 2; i++) {
      split(I[i], part, "/")
      for (j = 1; j <= 5; j++)
        printf "%.17g\n", (k[j] / 10)^2 * sqrt(1e7 * part[1] / part[2])
    }
    split(Iz, part, "/")
    for (j = 1; j <= 3; j++) {
      printf "%.17g\n", (2 * j - 1) * pi / 20 * sqrt(1e7 / 2.5 / 6 / (1 / 12 + part[1] / part[2]))
      printf "%.17g\n", (2 * j - 1) * pi / 20 * sqrt(1e7)
    }
  }' | sort -g | head -10
}

# compare NAME TOLERANCE IZ
compare() {
  "$COTREE" modes "$work/$1.yaml" -o "$work/$1.csv" 2>"$work/$1.summary"
  grep -q 'sparse symmetric' "$work/$1.summary" || { echo "$1: not sparse"; exit 1; }
  exact "$3" >"$work/exact"
  awk -F, -v name="$1" -v tolerance="$2" '
    FNR == NR { exact[FNR] = $1; next }
    FNR > 1 {
      d = $3 / exact[FNR - 1] - 1
      n++
      if (!(d < tolerance && d > -tolerance)) { print name ", mode " $1 ": " $3 ", wanted " exact[FNR - 1]; bad = 1 }
    }
    END { exit bad || n != 10 }' "$work/exact" "$work/$1.csv"
}

# what linear shapes of stretch and twist leave is (pi (2 j - 1)/2)^2/(24 N^2); bending is right to N^4 round-off errors
beams 1 200 1/10 >"$work/one.yaml"
compare one 3e-5 1/10
beams 20 10 1/10 >"$work/chain.yaml"
compare chain 3e-5 1/10
# two of each bending frequency
beams 1 200 1/12 >"$work/round.yaml"
compare round 6e-5 1/12
# 60 bodies in absolute coordinates, 360 speeds, with ten freedoms, all of which are modes: as through the joints
hinges() {
  awk 'BEGIN {
    print "cotree: 1\ngravity: [0, 0, 0]\nbodies:"
    for (i = 0; i < 60; i++)
      print "  b" i ": {type: rigid, mass: 1, inertia: [0.1, 0.2, 0.3], points: {tip: [1, 0, 0]}}"
    print "joints:"
    for (i = 0; i < 60; i++)
      print "  j" i ": {type: " (i % 6 ? "weld" : "revolute, axis: " (i % 4 ? "z" : "y") ", stiffness: 1000") \
        ", from: " (i ? "b" i - 1 ".tip" : "ground") ", to: b" i "}"
  }'
}
hinges >"$work/hinges.yaml"
"$COTREE" modes "$work/hinges.yaml" --tree joints --count 12 -o "$work/joints.csv" -q
"$COTREE" modes "$work/hinges.yaml" --tree absolute --count 12 -o "$work/absolute.csv" 2>"$work/summary"
grep -q 'sparse symmetric' "$work/summary" || { echo 'hinges: not sparse'; exit 1; }
if grep 'left out' "$work/summary"; then exit 1; fi
awk -F, '
  FNR == NR { joints[FNR] = $3; n = FNR; next }
  FNR > 1 { d = $3 / joints[FNR] - 1; if (d * d > 1e-20) { print "hinges, mode " $1 ": " $3 ", wanted " joints[FNR]; bad = 1 } }
  END { exit bad || n != 11 || FNR != 11 }' "$work/joints.csv" "$work/absolute.csv"
# 60 bodies that turn each on its own: many equal frequencies sqrt(k/I), and two bodies without mass that have none
alone() {
  awk 'BEGIN {
    print "cotree: 1\ngravity: [0, 0, 0]\nbodies:"
    for (i = 0; i < 60; i++)
      print "  b" i ": {type: rigid, mass: " (i == 7 || i == 33 ? 0 : "1, inertia: [0.1, 0.2, 0.3]") "}"
    print "joints:"
    for (i = 0; i < 60; i++)
      print "  j" i ": {type: revolute, axis: " (i % 2 ? "z" : "y") ", from: ground, to: b" i ", stiffness: " (i < 40 ? 1000 : 2000) "}"
  }'
}
alone >"$work/alone.yaml"
"$COTREE" modes "$work/alone.yaml" --tree absolute --count 50 -o "$work/alone.csv" 2>"$work/summary"
grep -q 'sparse symmetric' "$work/summary" || { echo 'alone: not sparse'; exit 1; }
awk -F, 'NR > 1 {
    want = sqrt(NR <= 19 ? 1000 / 0.3 : NR <= 39 ? 1000 / 0.2 : NR <= 49 ? 2000 / 0.3 : 2000 / 0.2)
    d = $3 / want - 1
    if (d * d > 1e-20) { print "alone, mode " $1 ": " $3 ", wanted " want; bad = 1 }
  }
  END { exit bad || NR != 51 }' "$work/alone.csv"
echo same

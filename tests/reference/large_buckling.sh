#!/bin/sh
# large_buckling.sh: columns that are too large for full matrices. Euler: (2 j - 1)^2 pi^2 E I/(4 L^2), twice for a column
# that bends about two axes alike; frequencies on the way are those of a column with full matrices. A chain of beams welded end to end is
# that of small systems.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# beams NBEAM NELEMENT
beams() {
  awk -v n="$1" -v elements="$2" 'BEGIN {
    print "cotree: 1\nbodies:"
    for (i = 0; i < n; i++)
      printf "  b%d: {type: beam, length: 10/%d, elements: %d, mass_per_length: 1, E: 1e7, nu: 0.25, area: 1, Iy: 1/12," \
        " Iz: 1/12, J: 1/6, points: {tip: length}, formulation: foreshortening," \
        " deformation: [axial, bending-y, bending-z, torsion]}\n", i, n, elements
    print "joints:\n  j0: {type: weld, from: ground, to: b0}"
    for (i = 1; i < n; i++)
      printf "  j%d: {type: weld, from: b%d.tip, to: b%d}\n", i, i - 1, i
    printf "forces: {push: {type: force, at: b%d.tip, value: [-1, 0, 0]}}\n", n - 1
  }'
}

# compare FILE TOLERANCE, wanted numbers on stdin
compare() {
  awk -F, -v name="$1" -v tolerance="$2" '
    FNR == NR { want[FNR] = $1; n = FNR; next }
    FNR > 1 {
      d = $2 / want[FNR - 1] - 1
      found++
      if (!(d < tolerance && d > -tolerance)) { print name ", factor " $1 ": " $2 ", wanted " want[FNR - 1]; bad = 1 }
    }
    END { if (found != n) print name ": " found " factors, wanted " n; exit bad || found != n }' - "$1"
}

cd "$work"
beams 1 60 >one.yaml
"$COTREE" buckling one.yaml --load push --count 4 --curve curve.csv -o one.csv 2>summary
grep -q 'refined on the path' summary
beams 1 24 >few.yaml
"$COTREE" buckling few.yaml --load push --count 2 --curve few.csv -o few_factors.csv -q
awk 'BEGIN { for (j = 0; j < 4; j++) printf "%.17g\n", (1 + 2 * int(j / 2))^2 * (4 * atan2(1, 1))^2 * 1e7 / 12 / 400 }' | compare one.csv 1e-6
awk -F, '
  FNR == NR { few[FNR] = $2; next }
  FNR > 1 && FNR < 22 { d = $2 / few[FNR] - 1; rows++; if (d * d > 1e-10) { print "curve, row " FNR ": " $2 ", wanted " few[FNR]; bad = 1 } }
  END { if ($2 * $2 > 1e-6) print "curve: " $2 " Hz at the end"; exit bad || rows != 20 || $2 * $2 > 1e-6 }' few.csv curve.csv

# a load that turns with the end has no potential: here that is seen beside 100 times stiffer elements
beams 1 60 | sed 's/value: \[-1, 0, 0\]/&, in: b0.tip/' >follows.yaml
"$COTREE" buckling follows.yaml --load push --count 1 -o follows.csv 2>summary || true
grep -q 'has no potential' summary || { echo "a following load has a potential"; cat summary; exit 1; }

# through the joints there are no rows, from ground there are
beams 8 8 >chain.yaml
"$COTREE" buckling chain.yaml --load push --count 2 --tree joints -o joints.csv -q
"$COTREE" buckling chain.yaml --load push --count 2 --tree absolute -o absolute.csv -q
tail -n +2 joints.csv | cut -d, -f2 | compare absolute.csv 1e-9

# A strip that is pushed across bends before it tips over: the path of equilibria leads to three times the factor of the linear
# problem, and is followed with sparse matrices. Dense ones find 3322.09469568 at 60 elements.
beams 1 60 | sed 's/value: \[-1, 0, 0\]/value: [0, 0, 1]/; s,Iz: 1/12,Iz: 1/1200,' >strip.yaml
"$COTREE" buckling strip.yaml --load push --count 2 -o strip.csv 2>summary
if grep 'dense matrices' summary; then exit 1; fi
echo 3322.09469568 | compare strip.csv 1e-8

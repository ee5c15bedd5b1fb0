# A satellite with two booms: frequencies of mass and stiffness matrices written down by hand (README.md there), and what a
# body that floats keeps after a torque of known impulse.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/two_boom_satellite/model.yaml
"$COTREE" modes "$m" --count 9 -o modes.csv --quiet
printf '%s\n' 0 0 0 2.70893995 5.83314544 16.7767813 18.3979716 56.3820305 57.1893497 >want
cut -d, -f3 modes.csv | sed 1d | paste - want | awk '
  { d = $1 - $2; if (d < 0) d = -d; if (d > 3e-9 * ($2 + 1000)) { print "mode " NR ": " $1 ", by hand " $2; bad = 1 } }
  END { if (!bad && NR == 9) print NR " frequencies" }'

"$COTREE" simulate "$m" --until 3 -o run.csv --quiet
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
  function near(name, value, by) {
    d = $column[name] - value
    if (d > by || d < -by) { print "at " $1 " s: " name " is " $column[name]; bad = 1 }
  }
  $1 >= 1 { near("spin", 2.5464790894703, 1e-8) }
  { near("x", 0, 1e-10); near("y", 0, 1e-10); near("energy.total", 0, 1e-8) }
  END { if (!bad && NR == 62) print "angular momentum 8/pi, centre of mass at rest, energy balanced" }' run.csv

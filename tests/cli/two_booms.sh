# A satellite with two booms: frequencies of mass and stiffness matrices written down by hand (README.md there), and what a
# body that floats keeps after a torque of known impulse.
. "$(dirname "$0")/lib.sh"
# FILE FREQUENCY...: the lowest ones are these; digits beyond the ninth and what stands for zero are round-off.
frequencies() {
  "$COTREE" modes "$SYSTEMS/two_boom_satellite/$1" --count $(($# - 1)) -o modes.csv --quiet
  name=$1
  shift
  printf '%s\n' "$@" >want
  cut -d, -f3 modes.csv | sed 1d | paste - want | awk -v name="$name" -v want=$# '
    { d = $1 - $2; if (d < 0) d = -d; if (d > 1e-8 * $2 + 3e-6) { print name ": mode " NR ": " $1 ", by hand " $2; bad = 1 } }
    END { if (!bad && NR == want) print name ": " NR " frequencies" }'
}

# FILE QUANTITY=VALUE...: these are kept from 1 s on, the centre of mass and the energy from the start.
kept() {
  "$COTREE" simulate "$SYSTEMS/two_boom_satellite/$1" --until 3 -o run.csv --quiet
  name=$1
  shift
  awk -F, -v name="$name" -v wants="$*" '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; n = split(wants, want, "[= ]"); next }
    function near(what, value, by) {
      d = $column[what] - value
      if (!(what in column) || d > by || d < -by) { print name ": at " $1 " s " what " is " $column[what]; bad = 1 }
    }
    $1 >= 1 { for (i = 1; i < n; i += 2) near(want[i], want[i + 1], 1e-8) }
    { near("x", 0, 1e-10); near("energy.total", 0, 1e-8) }
    END { if (!bad && NR == 62) print name ": angular momentum, centre of mass, energy" }' run.csv
}

frequencies model.yaml 0 0 0 2.70893995 5.83314544 16.7767813 18.3979716 56.3820305 57.1893497
kept model.yaml spin=2.5464790894703
frequencies space.yaml 0 0 0 0 0 0 2.70893995 2.70893995 5.83314544 6.64406300 16.7767813 16.7767813 18.3979716 19.3627672
kept space.yaml spin_x=0 spin_y=0.63661977236758 spin_z=2.5464790894703

#!/bin/sh
# closure_by_bending.sh CASE: beams that must be bent far before a loop closes, in equilibrium at the start.
#   arc      a cantilever whose end is welded to ground a quarter and half a circle on: all of it is that circle, and its energy
#            EI angle^2/(2 L); in the plane and with the rows of space
#   couple   a couple at the free end bends it to a whole circle; no loop
#   elastica a strip of 1 m between two pins, k = sin(a/2) with the slope a at the pins: their distance is 2 E/K - 1, its height
#            k/K, the force 4 K^2 EI; straight at first, so that it must buckle, to the side of the guess, with an axis that does
#            not stretch
#   bars     R10 (systems/flexible_four_bar) at 60 degrees
# COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# strip K DEFORMATION FIRST LAST: K chord-frame beams of 1 m in all from the joint FIRST to the joint LAST at ground.far
strip() {
  awk -v K="$1" -v deformation="$2" -v first="$3" -v last="$4" 'BEGIN {
    for (i = 1; i <= K; i++)
      printf "  b%d: {type: beam, length: 1/%d, mass_per_length: 1, rotary_inertia: [1e-3, 1e-3, 1e-3], E: 1, G: 1, area: 1e6, Iy: 1," \
        " Iz: 1, J: 1, formulation: foreshortening, frame: chord, deformation: [%s], points: {end: length}, initial: equilibrium}\n", i, K, deformation
    print "joints:\n  j1: {" first ", from: ground, to: b1}"
    for (i = 2; i <= K; i++)
      printf "  j%d: {type: weld, from: b%d.end, to: b%d}\n", i, i - 1, i
    if (last != "")
      printf "  last: {%s, from: b%d.end, to: ground.far}\n", last, K
  }'
}

# start MODEL OPTION...: first row of the outputs
start() {
  model=$1
  shift
  "$COTREE" simulate "$model" --until 1e-9 --samples 2 --quiet -o "$work/start.csv" "$@"
  sed -n 2p "$work/start.csv"
}

# arc DEGREES DEFORMATION OPTION...
arc() {
  degrees=$1 deformation=$2
  shift 2
  {
    awk -v angle="$degrees" 'BEGIN {
      a = angle * 3.14159265358979323846 / 180
      printf "cotree: 1\nbodies:\n  ground: {points: {far: {at: [%.17g, %.17g, 0], rotate: [z, %d*pi/180]}}}\n", sin(a) / a, (1 - cos(a)) / a, angle
    }'
    strip 4 "$deformation" 'type: weld' 'type: weld'
    echo 'outputs: [b2.end.position.x, b2.end.position.y, energy.strain]'
  } >"$work/arc.yaml"
  start "$work/arc.yaml" "$@" | awk -F, -v angle="$degrees" '
    function size(x) { return x < 0 ? -x : x }
    {
      a = angle * 3.14159265358979323846 / 180
      h = a / 4 # half the angle of a beam: its frame sees slopes up to that; of an arc they are right to their square over 24
      e = size($2 - sin(a / 2) / a) + size($3 - (1 - cos(a / 2)) / a)
      d = size($4 / (a * a / 2) - 1)
      printf "arc of %d degrees: place off by %.1e, energy by %.1e\n", angle, e, d
      exit !(e < (h / 2)^4 / 24 && d < (h / 2)^4 / 24)
    }'
}

case $1 in
arc)
  arc 90 'axial, bending-z'
  arc 180 'axial, bending-z'
  arc 90 'axial, bending-y, bending-z, torsion' --keep-all
  ;;
couple)
  {
    echo 'cotree: 1'
    echo 'bodies:'
    strip 8 'axial, bending-z' 'type: weld' ''
    echo 'forces: {couple: {type: torque, on: b8.end, value: [0, 0, 2*pi]}}'
    echo 'outputs: [b4.end.position.x, b4.end.position.y, b8.end.position.x, b8.end.position.y]'
  } >"$work/couple.yaml"
  start "$work/couple.yaml" | awk -F, '
    function size(x) { return x < 0 ? -x : x }
    {
      e = size($2) + size($3 - 1 / 3.14159265358979323846) + size($4) + size($5)
      printf "whole circle: off by %.1e\n", e
      exit !(e < 4 * (3.1416 / 16)^4 / 24)
    }'
  ;;
elastica) # a = 60 degrees: K = 1.6857503548, E = 1.4674622093
  for K in 4 -8; do
    side=${K%%[48]}1 K=${K#-}
    {
      echo 'cotree: 1'
      echo 'bodies:'
      echo '  ground: {points: {far: [0.741019606076327, 0, 0]}}'
      strip $K bending-z "type: revolute, axis: z, initial: {q: $side, guess: true}" 'type: revolute, axis: z'
      echo "outputs: [b$((K / 2)).end.position.y, j1.force.x, j1.q]"
    } >"$work/elastica.yaml"
    echo "$K,$side,$(start "$work/elastica.yaml")"
  done | awk -F, '
    function size(x) { return x < 0 ? -x : x }
    {
      e = size($2 * $4 / 0.296603823082443 - 1)
      f = size($5 / 11.3670170350032 - 1)
      g = size($2 * $6 / 1.0471975511965976 - 1)
      printf "%d frames: height off by %.1e, force by %.1e, slope by %.1e\n", $1, e, f, g
      if (NR == 2 && !(before[1] >= 8 * e && before[2] >= 8 * f && before[3] >= 8 * g)) bad = 1
      before[1] = e; before[2] = f; before[3] = g
    }
    END { exit bad || NR != 2 }' # at least the third power of the number of frames
  ;;
bars)
  for n in 1 2; do
    sed -e "s/elements: .*/elements: $n/" -e 's/    frame: chord/&\n    initial: equilibrium/' \
      -e 's|motion: .*}|motion: "-pi/6"}|' -e 's|from: bar1.end, to: bar2|&, initial: {q: -pi/3, guess: true}|' \
      -e 's|from: bar2.end, to: bar3|&, initial: {q: -pi/3, guess: true}|' \
      "$folder/../../systems/flexible_four_bar/model.yaml" >"$work/bars.yaml"
    start "$work/bars.yaml" | cut -d , -f 2-7
  done | { sed -n 's/^20,//p' "$folder/R10.reference.csv" | cut -d , -f 1-6; cat; } | awk -F, '
    function size(x) { return x < 0 ? -x : x }
    NR == 1 { for (i = 1; i <= 6; i++) want[i] = $i; next }
    { for (i = 1; i <= 6; i++) if (size($i - want[i]) > error[NR]) error[NR] = size($i - want[i]) }
    END {
      printf "four-bar at 60 degrees: places off by %.1e m with 1 element, by %.1e m with 2\n", error[2], error[3]
      exit !(NR == 3 && error[2] >= 3 * error[3] && error[3] < 0.01 * 0.24)
    }'
  ;;
*)
  echo "closure_by_bending.sh: no case $1" >&2
  exit 2
  ;;
esac

#!/bin/sh
# beam_tables.sh KIND: the lines of beam_tables.txt of a kind (modes, buckling, weight, accelerated) from YAML through the command
# line, to a relative tolerance.
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}"
kind=$1
tolerance=1e-9 # the condition of a mesh of 32 elements, N^4, in roundings
# next to the critical acceleration the frequency is a small difference
[ "$kind" = accelerated ] && tolerance=1e-8
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# write_model THEORY INTEGRATION MASS ROTARY GEOMETRIC FORMULATION DEFORMATION
write_model() {
  cat <<END
cotree: 1
gravity: [-a, 0, 0]
parameters: {h: 1, n: 1, a: 0}
bodies:
  beam:
    type: beam
    length: 10
    elements: n
    mass_per_length: 1
    E: 1e7
    nu: 0.3
    area: h
    Iy: h^3/12
    Iz: h^3/12
    shear_factor: 1
    theory: $1
    integration: $2
    mass: $3
$([ "$4" = 0 ] || echo "    rotary_inertia: [0, h^3/12, h^3/12]")
    geometric_stiffness: $5
    formulation: $6
    deformation: $7
    points: {tip: length}
joints:
  clamp: {type: weld, from: ground, to: beam}
forces:
  push: {type: force, at: beam.tip, value: [-h*(a == 0), 0, 0]}
END
}

# compare WHAT COLUMN VALUES ...: the rows of $work/got
compare() {
  title=$1
  column=$2
  shift 2
  printf '%s\n' "$@" | awk -F, -v tolerance=$tolerance -v what="$title" -v column="$column" '
    FNR == NR { if (FNR > 1) got[FNR - 1] = $column; next }
    {
      d = got[FNR] / $1 - 1
      if (!(FNR in got) || !(d < tolerance && d > -tolerance)) {
        print what ", mode " FNR ": " got[FNR] ", wanted " $1
        bad = 1
      }
    }
    END { exit bad }' "$work/got" - || bad=1
}

count=0
while read -r what table theory integration mass rotary geometric h n values; do
  [ "$what" = "$kind" ] || continue
  count=$((count + 1))
  formulation=foreshortening
  [ "$kind" = modes ] && formulation=linear
  column=2
  case $kind in
  modes)
    set -- modes --count 1000
    column=3
    ;;
  buckling) set -- buckling --load push --count 5 ;;
  weight) set -- buckling --load gravity --count 1 --set a=1 ;;
  accelerated)
    set -- modes --count 1 --set "a=${values% *}"
    values=${values#* }
    column=3
    ;;
  esac
  command=$1
  shift
  # what buckles does so whether its axis is rigid or not; its stress resultants are the same
  for deformation in '[bending-z]' '[axial, bending-z]'; do
    [ "$deformation" = '[bending-z]' ] || [ "$kind" = buckling ] || continue
    write_model "$theory" "$integration" "$mass" "$rotary" "$geometric" "$formulation" "$deformation" >"$work/model.yaml"
    "$COTREE" "$command" "$work/model.yaml" "$@" --set "h=$h" --set "n=$n" --quiet >"$work/got"
    # shellcheck disable=SC2086
    compare "$table, $n elements, $deformation" $column $values
  done
  # nor do masses matter to it
  if [ "$kind" = buckling ] && [ "$n" -le 8 ]; then
    write_model "$theory" "$integration" lumped 0 "$geometric" "$formulation" '[bending-z]' >"$work/model.yaml"
    "$COTREE" "$command" "$work/model.yaml" "$@" --set "h=$h" --set "n=$n" --quiet >"$work/got"
    # shellcheck disable=SC2086
    compare "$table, $n elements, lumped" $column $values
  fi
done <"$folder/beam_tables.txt"
echo "$count lines"
[ "$count" -gt 0 ] && [ -z "${bad:-}" ]

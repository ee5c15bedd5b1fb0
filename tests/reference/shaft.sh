#!/bin/sh
# shaft.sh: torsional and longitudinal vibration of a clamped shaft in N elements, first frequency against pi/(2 L) sqrt(G J/j)
# and pi/(2 L) sqrt(E A/m). Of shapes of degree p the first term of the error is, with k h = pi/(2 N), (k h)^2/24 of linear and (k h)^4/1440 of quadratic ones.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for case in 'twist linear 2' 'twist linear 8' 'twist quadratic 2' 'twist quadratic 4' 'twist quadratic 8' \
  'stretch linear 4' 'stretch quadratic 2' 'stretch quadratic 4' 'stretch quadratic 8'; do
  set -- $case
  family=torsion speed=8.75
  [ "$1" = twist ] || { family=axial speed=0.33333333333333333; } # squared
  cat >"$work/shaft.yaml" <<END
cotree: 1
bodies:
  shaft: {type: beam, length: 2, elements: $3, mass_per_length: 3, E: 1, G: 5, area: 1, Iy: 1, Iz: 1, J: 0.7, rotary_inertia: [0.4, 0.2, 0.2],
    formulation: foreshortening, deformation: [$family], $1: $2}
joints:
  clamp: {type: weld, from: ground, to: shaft}
END
  "$COTREE" modes "$work/shaft.yaml" -o "$work/modes.csv" --quiet
  awk -F, -v kind="$1" -v shapes="$2" -v n="$3" -v speed="$speed" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == "omega_rad_s") column = i }
    NR == 2 {
      pi = 3.14159265358979323846
      kh = pi / 2 / n
      wanted = shapes == "linear" ? kh^2 / 24 : kh^4 / 1440
      got = $column / (pi / 4 * sqrt(speed)) - 1
      printf "%s %s, %d: error %.3e, theory %.3e\n", shapes, kind, n, got, wanted
      # the next term of the series is of order (k h)^2 against the first
      exit !(got > wanted * (1 - kh^2) && got < wanted * (1 + kh^2))
    }
    END { if (NR < 2) exit 1 }' "$work/modes.csv"
done

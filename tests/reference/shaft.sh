#!/bin/sh
# shaft.sh: torsional vibration of a clamped shaft in N elements, first frequency against pi/(2 L) sqrt(G J/j). Of shapes of
# degree p the first term of the error is, with k h = pi/(2 N), (k h)^2/24 of linear and (k h)^4/1440 of quadratic ones.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for case in 'linear 2' 'linear 8' 'quadratic 2' 'quadratic 4' 'quadratic 8'; do
  set -- $case
  cat >"$work/shaft.yaml" <<END
cotree: 1
bodies:
  shaft: {type: beam, length: 2, elements: $2, mass_per_length: 3, E: 1, G: 5, area: 1, Iy: 1, Iz: 1, J: 0.7, rotary_inertia: [0.4, 0.2, 0.2],
    formulation: foreshortening, deformation: [torsion], twist: $1}
joints:
  clamp: {type: weld, from: ground, to: shaft}
END
  "$COTREE" modes "$work/shaft.yaml" -o "$work/modes.csv" --quiet
  awk -F, -v shapes="$1" -v n="$2" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == "omega_rad_s") column = i }
    NR == 2 {
      pi = 3.14159265358979323846
      kh = pi / 2 / n
      wanted = shapes == "linear" ? kh^2 / 24 : kh^4 / 1440
      got = $column / (pi / 4 * sqrt(5 * 0.7 / 0.4)) - 1
      printf "%s, %d: error %.3e, theory %.3e\n", shapes, n, got, wanted
      # the next term of the series is of order (k h)^2 against the first
      exit !(got > wanted * (1 - kh^2) && got < wanted * (1 + kh^2))
    }
    END { if (NR < 2) exit 1 }' "$work/modes.csv"
done

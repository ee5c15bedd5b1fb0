#!/bin/sh
# generate.sh [K [N [TWIST]]]: writes the right-angle cantilever, each leg cut into K beams of N elements, to standard output.
# TWIST: linear or quadratic.
LC_ALL=C exec awk -v K="${1:-4}" -v N="${2:-1}" -v twist="${3:-quadratic}" '
BEGIN {
  if (K !~ /^[1-9][0-9]*$/ || N !~ /^[1-9][0-9]*$/) {
    print "generate.sh: K and N are positive integers" > "/dev/stderr"
    exit 2
  }
  printf "cotree: 1\nname: right-angle cantilever, legs of %d beams\n", K
  printf "description: Two legs at a right angle, %d beams of %d elements each, swing freely after a push at the elbow out of their plane.\n\n", K, N
  printf "parameters:\n  EA: 1e6         # N\n  EI: 1e3         # N m^2, both planes and torsion\n\nbodies:\n"
  for (k = 1; k <= 2 * K; k++) {
    printf "  part%d:\n    type: beam\n    length: 10/%d\n    elements: %d\n    mass_per_length: 1\n    rotary_inertia: [20, 10, 10]\n", k, K, N
    printf "    E: 1\n    G: 1\n    area: EA\n    Iy: EI\n    Iz: EI\n    J: EI\n"
    printf "    formulation: foreshortening\n    frame: chord\n    twist: %s\n", twist
    printf "    deformation: [bending-y, bending-z, torsion]\n"
    printf "    points: {end: %s}\n", (k == K ? "{at: length, rotate: [[z, pi/2]]}" : "length")
  }
  printf "\njoints:\n  clamp: {type: weld, from: ground, to: part1}\n"
  for (k = 2; k <= 2 * K; k++)
    printf "  weld%d: {type: weld, from: part%d.end, to: part%d}\n", k, k - 1, k
  printf "\nforces:\n  push: {type: force, at: part%d.end, value: [0, 0, \"if(t < 1, 50*t, if(t < 2, 50*(2 - t), 0))\"]}\n", K
  printf "\noutputs:\n"
  for (c = 1; c <= 3; c++) printf "  - {name: tip_%s, value: part%d.end.position.%s}\n", substr("xyz", c, 1), 2 * K, substr("xyz", c, 1)
  for (c = 1; c <= 3; c++) printf "  - {name: elbow_%s, value: part%d.end.position.%s}\n", substr("xyz", c, 1), K, substr("xyz", c, 1)
  printf "  - energy.kinetic\n  - energy.total\n\nsimulation:\n  duration: 10\n  interval: 1\n  tolerance: 1e-5\n  method: dop853\n"
}'

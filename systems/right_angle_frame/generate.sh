#!/bin/sh
# generate.sh [K [N [TWIST]]]: writes the right-angle frame, each leg cut into K beams of N elements, to standard output.
# TWIST: linear or quadratic.
LC_ALL=C exec awk -v K="${1:-2}" -v N="${2:-1}" -v twist="${3:-linear}" '
BEGIN {
  if (K !~ /^[1-9][0-9]*$/ || N !~ /^[1-9][0-9]*$/) {
    print "generate.sh: K and N are positive integers" > "/dev/stderr"
    exit 2
  }
  printf "cotree: 1\nname: right-angle frame, legs of %d beams\n", K
  printf "description: Two legs of a thin upright strip at a right angle, loaded in their plane at the free end, buckle sideways.\n\n"
  printf "parameters:\n  load: 1          # N, along the first leg; -1: towards the clamp\n  E: 7.124e10\n  nu: 0.31\n"
  printf "  height: 0.03     # m, of the section, in the plane of the legs\n  thickness: 0.0006\n\nbodies:\n"
  for (k = 1; k <= 2 * K; k++) {
    printf "  part%d:\n    type: beam\n    length: 0.24/%d\n    elements: %d\n    density: 2700\n    rotary_inertia: true\n", k, K, N
    printf "    E: E\n    nu: nu\n    area: height*thickness\n    Iz: height^3*thickness/12\n    Iy: height*thickness^3/12\n    J: height*thickness^3/3\n"
    printf "    formulation: foreshortening\n    twist: %s\n    deformation: [axial, bending-z, bending-y, torsion]\n", twist
    printf "    points: {end: %s}\n", (k == K ? "{at: length, rotate: [[z, -pi/2]]}" : "length")
  }
  printf "\njoints:\n  clamp: {type: weld, from: ground, to: part1}\n"
  for (k = 2; k <= 2 * K; k++)
    printf "  weld%d: {type: weld, from: part%d.end, to: part%d}\n", k, k - 1, k
  printf "\nforces:\n  push: {type: force, at: part%d.end, value: [load, 0, 0]}\n", 2 * K
  printf "\noutputs:\n  - {name: along, value: part%d.end.position.x}\n  - {name: across, value: part%d.end.position.z}\n", 2 * K, 2 * K
  printf "  - energy.kinetic\n  - energy.total\n\nsimulation:\n  duration: 0.1\n  method: radau5\n  tolerance: 1e-6\n"
}'

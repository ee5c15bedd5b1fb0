#!/bin/sh
# generate.sh [K [N]]: writes the spin-up of a beam cut into K beams of N elements each to standard output.
LC_ALL=C exec awk -v K="${1:-4}" -v N="${2:-2}" '
BEGIN {
  if (K !~ /^[1-9][0-9]*$/ || N !~ /^[1-9][0-9]*$/) {
    print "generate.sh: K and N are positive integers" > "/dev/stderr"
    exit 2
  }
  printf "cotree: 1\nname: spin-up of a beam in %d parts\n", K
  printf "description: The cantilever of spin_up_beam cut into %d beams of %d elements, welded end to end, each with its own frame.\n\n", K, N
  printf "parameters:\n  speed: 6        # rad/s, of the hub from T on\n  T: 15           # s\n\nbodies:\n"
  for (k = 1; k <= K; k++) {
    printf "  part%d:\n    type: beam\n    length: 10/%d\n    elements: %d\n    density: 3000\n    E: 7e10\n", k, K, N
    printf "    area: 4e-4\n    Iz: 2e-7\n    formulation: foreshortening\n    points: {end: length}\n"
  }
  printf "\njoints:\n  hub:\n    type: revolute\n    from: ground\n    to: part1\n"
  printf "    motion: \"if(t < T, speed*(t^2/(2*T) + T/(4*pi^2)*(cos(2*pi*t/T) - 1)), speed*(t - T/2))\"\n"
  for (k = 2; k <= K; k++)
    printf "  weld%d: {type: weld, from: part%d.end, to: part%d}\n", k, k - 1, k
  printf "\noutputs:\n"
  printf "  - {name: along, value: part%d.end.position.x in part1 - 10}\n", K
  printf "  - {name: across, value: part%d.end.position.y in part1}\n", K
  printf "  - {name: torque, value: hub.effort}\n  - energy.kinetic\n  - energy.total\n"
  printf "\nsimulation:\n  duration: 20\n  interval: 0.05\n  tolerance: 1e-8\n  method: radau5\n"
}'

#!/bin/sh
# generate.sh [N [DURATION [INTERVAL [TOLERANCE]]]]: writes the chain of N links (N = 40 is the known
# problem) to standard output.
LC_ALL=C exec awk -v N="${1:-40}" -v duration="${2:-5}" -v interval="${3:-0.01}" -v tolerance="${4:-1e-8}" '
BEGIN {
  if (N !~ /^[1-9][0-9]*$/) { print "generate.sh: N is a positive integer" > "/dev/stderr"; exit 2 }
  printf "cotree: 1\nname: chain of %d links\n", N
  printf "description: Thin elastic beam of length, mass and bending stiffness 1 as %d hinged links, bent by a force at its tip.\n\n", N
  printf "bodies:\n"
  for (i = 1; i <= N; i++) {
    printf "  link%d: {mass: 1/%d, com: [1/%d, 0, 0], points: {end: [1/%d, 0, 0]}}\n", i, (i < N ? N : 2*N), N, N
  }
  printf "\njoints:\n"
  for (i = 1; i <= N; i++) {
    printf "  h%d: {type: revolute, from: %s, to: link%d, stiffness: %d, initial: {q: 0, u: 0}}\n",
      i, (i == 1 ? "ground" : "link" (i - 1) ".end"), i, (i == 1 ? 2*N : N)
  }
  printf "\nforces:\n  pull:\n    type: force\n    at: link%d.end\n", N
  printf "    value: [\"if(t < pi, -1.5*sin(t)^2, 0)\", \"if(t < pi, 1.5*sin(t)^2, 0)\", 0]\n"
  printf "\noutputs:                         # angles from +x, anticlockwise\n"
  for (i = 1; i <= N; i++) { q = (i == 1 ? "h1.q" : q " + h" i ".q"); printf "  - {name: theta%d, value: %s}\n", i, q }
  for (i = 1; i <= N; i++) { u = (i == 1 ? "h1.u" : u " + h" i ".u"); printf "  - {name: theta_rate%d, value: %s}\n", i, u }
  printf "  - {name: tip_x, value: link%d.end.position.x}\n  - {name: tip_y, value: link%d.end.position.y}\n", N, N
  printf "  - energy.kinetic\n  - energy.total\n"
  printf "\nsimulation:\n  duration: %s\n  interval: %s\n  tolerance: %s\n  absolute: 1e-10\n", duration, interval, tolerance
}'

#!/bin/sh
# generate.sh [N [DURATION [INTERVAL [TOLERANCE]]]]: writes the model of N four-bars in a row to standard output.
LC_ALL=C exec awk -v N="${1:-2}" -v duration="${2:-10}" -v interval="${3:-0.01}" -v tolerance="${4:-1e-11}" '
function bar(name, direction) {
  printf "  %s:\n    mass: 1\n    inertia: 1/12\n", name
  if (direction == "y") printf "    com: [0, 0.5, 0]\n    points: {end: [0, 1, 0]}\n"
  else                  printf "    com: [0.5, 0, 0]\n    points: {end: [1, 0, 0]}\n"
}
BEGIN {
  if (N !~ /^[1-9][0-9]*$/) { print "generate.sh: N is a positive integer" > "/dev/stderr"; exit 2 }
  printf "cotree: 1\nname: %d four-bar%s\n", N, (N == 1 ? "" : "s in a row")
  printf "description: %d cranks and %d couplers, all uniform bars of 1 m and 1 kg.\n\n", N + 1, N
  printf "gravity: [0, -9.81, 0]\n\nbodies:\n  ground:\n    points:\n"
  for (i = 0; i <= N; i++) printf "      a%d: [%d, 0, 0]\n", i, i
  for (i = 0; i <= N; i++) bar("crank" i, "y")
  for (i = 1; i <= N; i++) bar("coupler" i, "x")
  printf "\njoints:\n"
  printf "  foot0: {type: revolute, from: ground.a0, to: crank0, initial: {q: 0, u: -1}}\n"
  for (i = 1; i <= N; i++) printf "  foot%d: {type: revolute, from: ground.a%d, to: crank%d, initial: {q: 0, u: -1, guess: true}}\n", i, i, i
  for (i = 1; i <= N; i++) {
    printf "  left%d: {type: revolute, from: crank%d.end, to: coupler%d, initial: {q: 0, u: 1, guess: true}}\n", i, i - 1, i
    printf "  right%d: {type: revolute, from: coupler%d.end, to: crank%d.end, initial: {q: 0, u: -1, guess: true}}\n", i, i, i
  }
  printf "\noutputs:\n"
  printf "  - {name: B0_x, value: crank0.end.position.x}\n  - {name: B0_y, value: crank0.end.position.y}\n"
  printf "  - {name: vx, value: crank0.end.velocity.x}\n  - {name: vy, value: crank0.end.velocity.y}\n"
  printf "  - {name: theta, value: -foot0.q}            # from upright, clockwise\n  - {name: theta_rate, value: -foot0.u}\n"
  printf "  - energy.kinetic\n  - energy.potential\n  - energy.total\n"
  printf "\nsimulation:\n  duration: %s\n  interval: %s\n  tolerance: %s\n  absolute: 1e-12\n", duration, interval, tolerance
}'

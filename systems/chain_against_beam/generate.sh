#!/bin/sh
# generate.sh [N [n]]: writes a pendulum of n beam elements and one of N rigid links with springs to standard output.
LC_ALL=C exec awk -v N="${1:-16}" -v n="${2:-4}" '
BEGIN {
  if (N !~ /^[1-9][0-9]*$/ || n !~ /^[1-9][0-9]*$/) {
    print "generate.sh: N and n are positive integers" > "/dev/stderr"
    exit 2
  }
  printf "cotree: 1\nname: beam and chain of %d links\n", N
  printf "description: A flexible pendulum as a beam and as rigid links with springs between them; both fall from the horizontal.\n\n"
  printf "gravity: [0, -9.81, 0]\n\n"
  printf "parameters:\n  L: 1            # m\n  mu: 0.27        # kg/m\n  EI: 5.6         # N m^2\n"
  printf "  h: L/%d         # m, a link\n\n", N
  printf "bodies:\n  beam:\n    type: beam\n    length: L\n    elements: %d\n    mass_per_length: mu\n    E: EI\n    Iz: 1\n", n
  printf "    formulation: foreshortening\n    deformation: [bending-z]\n    points: {tip: length}\n"
  for (i = 1; i <= N; i++)
    printf "  link%d: {mass: mu*h, inertia: mu*h^3/12, com: [h/2, 0, 0], points: {end: [h, 0, 0]}}\n", i
  printf "\njoints:\n  pin: {type: revolute, from: ground, to: beam, initial: {q: 0, u: 0}}\n"
  for (i = 1; i <= N; i++)
    printf "  h%d: {type: revolute, from: %s, to: link%d%s, initial: {q: 0, u: 0}}\n",
      i, (i == 1 ? "ground" : "link" (i - 1) ".end"), i, (i == 1 ? "" : ", stiffness: EI/h")
  printf "\noutputs:\n"
  printf "  - {name: beam_x, value: beam.tip.position.x}\n  - {name: beam_y, value: beam.tip.position.y}\n"
  printf "  - {name: chain_x, value: link%d.end.position.x}\n  - {name: chain_y, value: link%d.end.position.y}\n", N, N
  printf "  - {name: bend, value: beam.tip.deflection.y}\n"
  printf "  - energy.kinetic\n  - energy.total\n"
  printf "\nsimulation:\n  duration: 1\n  interval: 0.005\n  tolerance: 1e-8\n"
}'

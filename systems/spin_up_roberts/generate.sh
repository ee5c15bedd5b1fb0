#!/bin/sh
# generate.sh [N [FORMULATION]]: writes the spin-up as loads on a beam that stands still, N elements, to standard output.
LC_ALL=C exec awk -v N="${1:-8}" -v formulation="${2:-linear}" '
BEGIN {
  if (N !~ /^[1-9][0-9]*$/) { print "generate.sh: N is a positive integer" > "/dev/stderr"; exit 2 }
  printf "cotree: 1\nname: spin-up as loads, %d elements\n", N
  printf "description: The forces of a spin-up on the lumped masses of a cantilever that stands still.\n\n"
  printf "parameters:\n"
  printf "  deformed: 0     # 1: the centrifugal force at the deformed place, 0: at the undeformed one\n"
  printf "  stiffening: 0   # 1: the stiffness by the axial force, as forces at the nodes, 0: without\n"
  printf "  mu: 1.2         # kg/m\n  h: 10/%d        # m, an element\n\n", N
  printf "bodies:\n  speed: {inertia: 1}   # carries the speed of the hub to the forces\n  beam:\n    type: beam\n    length: 10\n    elements: %d\n    mass_per_length: mu\n", N
  printf "    rotary_inertia: [6e-4, 6e-4, 6e-4]\n    E: 7e10\n    nu: 1/6\n    area: 4e-4\n    Iz: 2e-7\n"
  printf "    theory: timoshenko\n    shear_factor: 1/1.2\n    integration: one-point\n    mass: lumped\n"
  printf "    formulation: %s\n    deformation: [axial, bending-z]\n    points:\n", formulation
  for (i = 1; i <= N; i++) printf "      p%d: %s\n", i, (i < N ? i "*length/" N : "length")
  printf "\njoints:\n  clamp: {type: weld, from: ground, to: beam}\n  # its angle is the speed W(t) of the hub, its rate W\047\n"
  printf "  hub: {type: revolute, from: ground, to: speed, motion: \"if(t < 15, 6*(t/15 - sin(2*pi*t/15)/(2*pi)), 6)\"}\n"
  printf "\nforces:         # m (W^2 x + 2 W v\047), -m (W\047 x + 2 W u\047), W^2 mu/2 (L^2 - x^2) times the jump of the slope\n"
  for (i = 1; i <= N; i++) {
    p = "beam.p" i
    printf "  f%d:\n    type: force\n    at: %s\n    value:\n", i, p
    m = (i < N ? "mu*h" : "mu*h/2")
    printf "      - \"%s*(hub.q^2*(%d*h + deformed*%s.deflection.x) + 2*hub.q*%s.velocity.y)\"\n", m, i, p, p
    printf "      - \"%s*(hub.q^2*deformed*%s.deflection.y - hub.u*(%d*h + deformed*%s.deflection.x) - 2*hub.q*%s.velocity.x) ", m, p, i, p, p
    printf "+ stiffening*hub.q^2*mu/(2*h)*("
    if (i < N) printf "(100 - (%g*h)^2)*(beam.p%d.deflection.y - %s.deflection.y) - ", i + 0.5, i + 1, p
    else printf "-"
    printf "(100 - (%g*h)^2)*%s)\"\n", i - 0.5, (i > 1 ? "(" p ".deflection.y - beam.p" i - 1 ".deflection.y)" : p ".deflection.y")
    printf "      - 0\n"
  }
  printf "\noutputs:\n  - {name: along, value: beam.p%d.deflection.x}\n  - {name: across, value: beam.p%d.deflection.y}\n", N, N
  printf "  - energy.kinetic\n  - energy.total\n\nsimulation:\n  duration: 30\n  interval: 0.01\n  tolerance: 1e-7\n  method: radau5\n"
}'

# Signals that a force may depend on, and those that follow from forces.
. "$(dirname "$0")/lib.sh"

# model SIGNAL: a beam with a force at its tip that depends on the signal
model() {
  cat >model.yaml <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  arm: {type: beam, length: 1, elements: 1, E: 7e10, density: 2700, area: 1e-4, Iz: 8e-10, formulation: linear, points: {tip: length}}
joints:
  hub: {type: revolute, from: ground, to: arm}
forces:
  push: {type: force, at: arm.tip, value: [0, "$1", 0]}
outputs: [push.force.y, {name: wanted, value: "$1"}]
simulation: {duration: 0.01, samples: 3}
END
}

for signal in arm.com.x system.com.y system.momentum.y system.angular_momentum.z arm.tip.deflection.y; do
  echo "-- $signal"
  model "$signal"
  "$COTREE" simulate model.yaml --quiet -o run.csv 2>/dev/null || echo "exit $?"
  awk -F, 'NR > 1 && ($2 - $3) ^ 2 > 1e-24 { print "differs:", $0 } END { print NR - 1, "samples" }' run.csv
done

for signal in energy.kinetic energy.potential energy.strain energy.total energy.work arm.tip.moment.z arm.tip.force.x arm.validity \
  hub.force.x hub.a; do
  echo "-- $signal"
  model "$signal"
  say check model.yaml 2>&1 | sed -n '/error/p'
done

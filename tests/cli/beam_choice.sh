# What `formulation: auto` chooses, and why, does not depend on the trees: driven hubs, one that a torque turns, a beam on a wall.
model() { # JOINT HUB
  cat >arm.yaml <<END
cotree: 1
gravity: [0, $2, 0]
bodies:
  hub: {mass: 1, inertia: 2, points: {rim: [0.2, 0, 0]}}
  arm: {type: beam, length: 4, elements: 3, density: 2700, E: 7e10, nu: 0.3, area: 2.4e-3, Iz: 2e-6, points: {tip: length}}
joints:
  axle: {from: ground, to: hub, $1}
  clamp: {type: weld, from: hub.rim, to: arm}
outputs: [arm.tip.deflection.y]
simulation: {duration: 8, samples: 3}
END
  for tree in auto joints absolute; do
    "$COTREE" check arm.yaml --tree $tree | sed -n 's/.*bending-z; \(.*\);.*/\1/p'
  done
}
model 'type: revolute, motion: "if(t < 8, t^2/32 + 2/pi^2*(cos(pi*t/4) - 1), t/2 - 2)"' 0
model 'type: revolute, motion: "if(t < 2, 0.03*t^2, 0.12*t - 0.12)"' 0
model 'type: revolute, effort: "20*(1 - cos(pi*t/4))"' 0
model 'type: weld' -0.1
echo '-- stretch-linear: bodies on the beam are cut along with it where the trees count them from there'
cat >bob.yaml <<'END'
cotree: 1
bodies:
  rod: {type: beam, length: 1, elements: 4, formulation: stretch-linear, deformation: [axial, bending-z],
    density: 2700, E: 7e10, area: 1e-4, Iz: 1e-9, points: {tip: length, mid: length/2}}
  bob: {mass: 0.05, inertia: 1e-4, com: [0.1, 0, 0], points: {end: [0.2, 0, 0]}}
joints:
  root: {type: revolute, from: ground, to: rod, motion: "3*t^2*(1 - t/3)"}
  end: {type: revolute, from: rod.tip, to: bob, initial: {q: -1.0}}
outputs: [rod.tip.deflection.y, bob.end.position.y]
simulation: {duration: 1, samples: 3, tolerance: 1e-8}
END
for tree in joints absolute; do
  "$COTREE" check bob.yaml --tree $tree | grep 'second order' || echo "$tree: nothing"
  "$COTREE" simulate bob.yaml --tree $tree --quiet -o $tree.csv
done
sed 's/stretch-linear/foreshortening/' bob.yaml >all.yaml
"$COTREE" simulate all.yaml --quiet -o all.csv
for tree in joints absolute; do
  paste -d, all.csv $tree.csv | awk -F, -v tree=$tree '
    NR > 1 { d = $2 - $5; if (d < 0) d = -d; if (d > worst) worst = d; s = $2 < 0 ? -$2 : $2; if (s > size) size = s }
    END { is_near = worst < 5e-4*size; is_far = worst > 2e-3*size
          print tree ": " (is_near ? "within 0.05 % of all terms" : is_far ? "off by more than 0.2 %" : worst/size) }'
done

# A model that fails leaves nothing behind and an earlier result alone.
. "$(dirname "$0")/lib.sh"
sed 's/revolute/revolut/; s/^outputs:/outputs:\n  - nothing/' "$SYSTEMS/pendulum/model.yaml" >broken.yaml
say simulate broken.yaml
say check broken.yaml
echo before >broken.csv
say simulate broken.yaml -o broken.csv --quiet --summary s.json | tail -n 1
cat broken.csv
say simulate missing.yaml
sed 's/duration.*/method: auto/' "$SYSTEMS/pendulum/model.yaml" >endless.yaml
say simulate endless.yaml
say simulate endless.yaml --until 1 --quiet
say simulate endless.yaml --until 1 -o no/such/folder.csv
ls
echo '-- a table that ends before the run, and one that begins after its start'
printf 't,force\n0,1\n1,2\n2,0\n' >force.csv
cat >pushed.yaml <<'END'
cotree: 1
bodies: {cart: {mass: 1, inertia: 1}}
joints: {rail: {type: prismatic, from: ground, to: cart, effort: {table: force.csv, column: force, interpolate: linear}}}
outputs: [rail.q]
simulation: {duration: 3, samples: 4}
END
say simulate pushed.yaml --quiet
cut -d, -f1 pushed.csv.partial
say simulate pushed.yaml --quiet --until 2 -o - | cut -d, -f1
sed -i '2s/0/0.5/' force.csv
say simulate pushed.yaml --quiet --until 2 -o -
echo '-- speeds that contradict each other: one freedom, seven values; that of `apart` is met'
{
  echo 'cotree: 1'
  echo "bodies: {b1: {mass: 1}, b2: {mass: 1}, b3: {mass: 1}, b4: {mass: 1}, b5: {mass: 1}, b6: {mass: 1}, b7: {mass: 1}, free: {mass: 1}}"
  echo 'joints:'
  echo '  apart: {type: prismatic, axis: x, from: ground, to: free, initial: {u: 9}}'
  for i in 1 2 3 4 5 6 7; do
    echo "  s$i: {type: prismatic, axis: x, from: ground, to: b$i, initial: {u: $i}}"
    [ $i = 1 ] || echo "  g$i: {type: gear, joints: [s1, s$i], ratio: -1}"
  done
} >speeds.yaml
say check speeds.yaml
sed 's/, initial: {u: \([12]\)}/, motion: \1*t/; s/, initial: {u: [3-9]}//' speeds.yaml >motions.yaml
say check motions.yaml
echo '-- bars too short to close, whatever the initial value; long enough, but not with both values'
bars() {
    cat <<END
cotree: 1
bodies:
  ground: {points: {far: [1.3, 0, 0]}}
  p: {mass: 1, points: {end: [0.5, 0, 0]}}
  q: {mass: 1, points: {end: [$1, 0, 0]}}
  r: {mass: 1, points: {end: [$2, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: p, initial: {q: 0.4}}
  B: {type: revolute, from: p.end, to: q}
  D: {type: revolute, from: ground.far, to: r$3}
  C: {type: revolute, from: q.end, to: r.end}
END
}
bars 0.2 0.3 '' >short.yaml
say check short.yaml
bars 1.2 0.9 ', initial: {q: 0.2}' >both.yaml
say check both.yaml
echo '-- more steps than allowed: what moves fastest, and which output wants it followed'
cat >ringing.yaml <<'END'
cotree: 1
bodies: {bob: {type: particle, mass: 1}}
joints: {place: {type: free, from: ground, to: bob, initial: {q: [1, 0, 0], u: [0.01, 1, 0]}}}
forces: {spring: {type: spring, from: ground, to: bob, stiffness: 1e15, length: 1}}
outputs: [place.q1, place.a1]
simulation: {duration: 10, samples: 2, tolerance: 1e-8}
END
say simulate ringing.yaml --quiet | sed 's/at t = .* now/at t = T after N steps, of H now/'
sed -i 's/, place.a1//; s/0.01, 1, 0/1e-6, 1, 0/' ringing.yaml
say simulate ringing.yaml --quiet --until 1
echo '-- cranks of a parallelogram at 0.9 and 1.5 rad: each misses 1.2 by 0.3'
cat >parallelogram.yaml <<'END'
cotree: 1
bodies:
  ground: {points: {far: [0.5, 0, 0]}}
  a: {mass: 1, inertia: 1, points: {end: [0.3, 0, 0]}}
  b: {mass: 1, inertia: 1, points: {end: [0.3, 0, 0]}}
  bar: {mass: 1, inertia: 1, points: {end: [0.5, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: a, initial: {q: 0.9}}
  B: {type: revolute, from: ground.far, to: b, initial: {q: 1.5}}
  C: {type: revolute, from: a.end, to: bar}
  D: {type: revolute, from: bar.end, to: b.end}
END
say check parallelogram.yaml
echo '-- gears between driven joints alone, whose motions contradict them'
cat >geared.yaml <<'END'
cotree: 1
parameters: {r: 2}
bodies: {a: {mass: 1, inertia: 0.1}, b: {mass: 1, inertia: 0.2}}
joints:
  x: {type: revolute, from: ground, to: a, motion: t^2}
  y: {type: revolute, from: ground, to: b, motion: r*t^2}
  cog: {type: gear, joints: [y, x], ratio: 2}
outputs: [x.q, y.q]
simulation: {duration: 1, samples: 2}
END
say inverse geared.yaml --quiet -o - | cut -d, -f1-3
say kinematics geared.yaml --quiet --set r=2.1 | sed 's/t = .*: it/t = T: it/; s/open at .*/open/'
echo '-- a crank that turns farther than its rod reaches: the row is named'
cat >reach.yaml <<'END'
cotree: 1
bodies:
  crank: {mass: 1, inertia: 0.1, points: {pin: [0.3, 0, 0]}}
  rod: {mass: 1, inertia: 0.1, points: {end: [0.2, 0, 0]}}
  block: {mass: 1}
joints:
  drive: {type: revolute, from: ground, to: crank, motion: 0.3 + t}
  pin: {type: revolute, from: crank.pin, to: rod, initial: {q: -0.5, guess: true}}
  small_end: {type: revolute, from: rod.end, to: block}
  guide: {type: prismatic, from: ground, to: block, axis: x, initial: {q: 0.5, guess: true}}
outputs: [guide.q]
simulation: {duration: 2, samples: 11}
END
say kinematics reach.yaml --quiet | sed 's/t = .*: it/t = T: it/; s/open at .*/open/'
echo '-- a method of order 2 at a tolerance that its steps come to rounding with: what goes on is named'
"$COTREE" simulate "$SYSTEMS/n_four_bar/model.yaml" --method generalized-alpha-index3 --tolerance 1e-8 --quiet -o out.csv 2>&1 | sed -n "s/^cotree: note: \(steps of .*, of order 2\), .*\('method: .*\)/\1 ... \2/p"
echo '-- a force that is not a number behind a wall: implicit methods, whose derivatives end there, too, do not try for ever'
cat >wall.yaml <<'END'
cotree: 1
bodies:
  cart: {mass: 1}
joints:
  slide: {type: prismatic, axis: x, from: ground, to: cart, initial: {u: -1}, effort: 1e-3*sqrt(1 + slide.q)}
simulation: {duration: 2}
outputs: [slide.q]
END
for method in dop853 radau5 newmark generalized-alpha; do
  timeout 60 "$COTREE" simulate wall.yaml --method $method --quiet -o out.csv 2>&1 | sed -n "s/^cotree: error: at t = \(1[.]000\).*\[\(E301\)\]/$method \1 \2/p"
done

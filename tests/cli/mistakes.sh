# First mistakes, and what is said of them: which line, in words of the model, at once.
. "$(dirname "$0")/lib.sh"

# what steps cost tells how long it takes: the last row before a lock comes after some hundred of them
bar='points: {end: [0.3, 0, 0]}'
four_bar() { # FILE MOTION
  cat >"$1" <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {far: [0.4, 0, 0]}}
  crank: {mass: 1, inertia: 0.1, $bar}
  coupler: {mass: 1, inertia: 0.1, points: {end: [0.4, 0, 0]}}
  rocker: {mass: 1, inertia: 0.1, points: {end: [0.2, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: crank, $2}
  b: {type: revolute, from: crank.end, to: coupler, initial: {q: -1.1, guess: true}}
  c: {type: revolute, from: ground.far, to: rocker, initial: {q: 1, guess: true}}
  d: {type: revolute, from: coupler.end, to: rocker.end}
simulation: {duration: 2, samples: 2001}
outputs: [a.q, c.q]
END
}

four_bar locks.yaml 'motion: "0.8 + 3*t"'
for method in auto radau5 generalized-alpha; do
  say simulate locks.yaml -q --method $method -o locks.csv | sed 's/\(t = 0\.[0-9]\{4\}\)[0-9]*/\1/g'
  wc -l <locks.csv.partial
done
say kinematics locks.yaml -q -o locks.csv
say modes locks.yaml
four_bar swings.yaml 'motion: "1.2 + 0.6*sin(3*t)"'
say simulate swings.yaml -q -o swings.csv
# a freedom beside the driven one does not hide the lock
sed 's/^joints:/  bob: {mass: 1, com: [0, -0.1, 0], inertia: 0.01}\njoints:\n  hook: {type: revolute, from: coupler.end, to: bob}/' locks.yaml >hangs.yaml
say simulate hangs.yaml -q -o hangs.csv

# the one axis that keeps a loop from closing
four_bar odd.yaml 'initial: {q: 1, u: 3}'
sed 's/b: {type: revolute,/& axis: y,/' odd.yaml >odd_hinge.yaml
say check odd_hinge.yaml
sed 's/rocker: {.*/block: {mass: 1}/; /^  c: /d; s/^  d: {.*/  c: {type: revolute, from: coupler.end, to: block}\n  g: {type: prismatic, axis: z, from: ground, to: block}/; s/, c.q\]/]/' odd.yaml >odd_guide.yaml
say check odd_guide.yaml

cat >gear.yaml <<'END'
cotree: 1
bodies:
  w1: {mass: 1, inertia: 0.1}
  w2: {mass: 1, inertia: 0.1}
joints:
  j1: {type: revolute, from: ground, to: w1, initial: {u: 1}}
  j2: {type: revolute, from: ground, to: w2}
  g: {type: gear, joints: [j2.q1, j1.q1], ratio: 2}
simulation: {duration: 1, samples: 2}
outputs: [j1.u, j2.u]
END
say simulate gear.yaml -q -o -

cat >stuck.yaml <<'END'
cotree: 1
bodies:
  crank: {mass: 1, inertia: 0.1, points: {end: [0.1, 0, 0]}}
  rod: {mass: 1, inertia: 0.1, points: {end: [0.4, 0, 0]}}
  block: {mass: 1}
joints:
  a: {type: revolute, from: ground, to: crank, initial: {q: 1, u: 3}}
  b: {type: revolute, from: crank.end, to: rod}
  c: {type: revolute, from: rod.end, to: block}
  guide: {type: prismatic, from: ground, to: block, effort: "-20*sign(guide.u)", initial: {q: 0.4, guess: true}}
simulation: {duration: 1}
outputs: [a.q, guide.q]
END
say simulate stuck.yaml -q -o stuck.csv

cat >coarse.yaml <<'END'
cotree: 1
bodies:
  cart: {mass: 1}
joints:
  s: {type: prismatic, from: ground, to: cart, stiffness: 1e6, initial: {q: 1}}
simulation: {duration: 10, samples: 30, step: 0.1}
outputs: [s.q, energy.total]
END
say simulate coarse.yaml -q -o coarse.csv

for rod in 'mass: 1' 'mass: 0'; do
  cat >massless.yaml <<END
cotree: 1
bodies:
  rod: {$rod}
joints:
  pin: {type: revolute, from: ground, to: rod}
simulation: {duration: 1}
outputs: [pin.q]
END
  say simulate massless.yaml -q
  sed 's/revolute/prismatic/' massless.yaml >sled.yaml
  say simulate sled.yaml -q -o /dev/null
  sed '/joints/d; /pin: /d; s/pin.q/rod.position/' massless.yaml >alone.yaml
  say simulate alone.yaml -q
done

# degrees: in a table by its head, by `unit`, by `scale`
printf 't [ms],angle [deg],plain\n0,0,0\n500,45,45\n1000,90,90\n' >turn.csv
for column in angle '"angle [deg]"' 'plain, unit: deg' 'plain, scale: pi/180' plain; do
  cat >table.yaml <<END
cotree: 1
bodies:
  rod: {mass: 1, inertia: 1}
joints:
  pin: {type: revolute, from: ground, to: rod, motion: {table: turn.csv, interpolate: linear, column: $column}}
simulation: {duration: 1, samples: 2}
outputs: [pin.q, pin.u]
END
  say simulate table.yaml -q -o -
done

# States of the user's own in every command: printed, analysed, swept; in loops the same as a mechanical model of them; and
# what a rate cannot depend on.
. "$(dirname "$0")/lib.sh"

cat >position.yaml <<'END'
cotree: 1
name: position
parameters: {m: 2, c: 0.5, Kp: 40, Ki: 30, Kd: 8, lag: "50 ms"}
inputs:
  setpoint: {value: 1, unit: m}
states:
  integral: {rate: setpoint - slide.q, unit: m*s}
  force: {rate: (Kp*(setpoint - slide.q) + Ki*integral - Kd*slide.u - force)/lag, initial: 2, unit: N}
bodies:
  block: {mass: m}
joints:
  slide: {type: prismatic, from: ground, to: block, damping: c, effort: force}
outputs: [slide.q, integral, force, setpoint]
simulation: {duration: 5, samples: 3}
END
say equations position.yaml --show terminal,tree,reduced
say check position.yaml
say linearize position.yaml
say modes position.yaml -q | awk -F, 'NR > 1 { printf "%.6f %.6f\n", $3, $4; next } 1' # closed loop, s^4 + ... = 0
say equilibrium position.yaml -q | awk -F, 'NR > 2 { printf "%.9f %.9f %.9f %g\n", $2, $3 + 0, $4 + 0, $5; next } 1'
say buckling position.yaml --load slide.effort
sed 's/effort: force/motion: t/' position.yaml >driven.yaml
say kinematics driven.yaml

echo "-- an equilibrium far off, and what states are counted in"
cat >arm.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
states:
  integral: {rate: 2.5 - arm.q, unit: rad*s}
bodies:
  link: {mass: 1.5, inertia: 0.02, com: [0.8, 0, 0]}
joints:
  arm: {type: revolute, from: ground, to: link, effort: 30*(2.5 - arm.q) + 20*integral - 4*arm.u, initial: {q: -1.2}}
outputs: [arm.q, integral]
END
"$COTREE" equilibrium arm.yaml -q -o - | awk -F, 'NR > 1 { e = $2 - 2.5; f = 20*$3 - 1.5*9.81*0.8*cos(2.5); print e*e + f*f < 1e-20 ? "where torques meet" : $0 }'
for unit in 1 1e6; do # of pressure; eigenvalues are those of [0 1 0; -5000 -10 1e-4; 0 -5.6e9 -84]
  cat >oil.yaml <<END
cotree: 1
parameters: {A: 2e-3, V: 5e-4, bulk: 1.4e9, leak: 3e-11}
states:
  p: {rate: bulk/V*(1e-5 - A*rod.u - leak*$unit*p)/$unit}
bodies:
  mass: {mass: 20}
joints:
  rod: {type: prismatic, from: ground, to: mass, stiffness: 1e5, damping: 200, effort: A*$unit*p}
outputs: [rod.q]
END
  "$COTREE" modes oil.yaml -q | awk -F, 'NR > 1 { printf "%.8f %.8f\n", $3, $4 }'
done

echo "-- a sweep's rows are those of runs alone"
say sweep position.yaml --vary Ki=10:50:5 -o rows.csv -q
for run in 1 3 5; do
  Ki=$(sed -n "$((run + 1))p" rows.csv | cut -d, -f2)
  "$COTREE" simulate position.yaml --set Ki="$Ki" -q -o run.csv
  same_row "$run" "$(sed -n "$((run + 1))p" rows.csv | cut -d, -f3-6)"
done

# loop EFFORT HEAD: a slider-crank whose torque EFFORT is that of a controller which switches; HEAD has the controller
loop() {
  cat <<END
cotree: 1
$2
bodies:
  crank: {mass: 1, inertia: 0.02, com: [0.1, 0, 0], points: {pin: [0.2, 0, 0]}}
  rod: {mass: 1.5, inertia: 0.05, com: [0.3, 0, 0], points: {end: [0.6, 0, 0]}}
  slider: {mass: 0.7}
$3
joints:
  main: {type: revolute, from: ground, to: crank, effort: $1, initial: {q: 0.5, u: 1}}
  pin: {type: revolute, from: crank.pin, to: rod}
  end: {type: revolute, from: rod.end, to: slider}
  guide: {type: prismatic, from: ground, to: slider}
$4
outputs: [main.q, main.u, guide.q, guide.force.y, {name: torque, value: $1}]
simulation: {duration: 2, samples: 21, tolerance: 1e-10}
END
}
torque="6*(4 - main.u) + 8*ERROR + if(guide.q > 0.6, 3, -1)*guide.u - TORQUE"
rate() {
  echo "\"($(echo "$torque" | sed "s/ERROR/$1/; s/TORQUE/$2/"))/0.03\""
}
loop torque "states:
  error: {rate: 4 - main.u}
  torque: {rate: $(rate error torque)}" "" "" >loop.yaml
loop second.u "" "  one: {mass: 1}
  other: {mass: 1}" "  first: {type: prismatic, from: ground, to: one, effort: 4 - main.u}
  second: {type: prismatic, from: ground, to: other, effort: $(rate first.u second.u)}" >twin.yaml
echo "-- in a loop states are as masses that forces of their rates push"
"$COTREE" simulate loop.yaml -q -o loop.csv && "$COTREE" simulate twin.yaml -q -o twin.csv
difference loop.csv twin.csv | awk '{ print $1 < 1e-9 ? "the same" : $1 }'
for tree in joints absolute; do
  "$COTREE" simulate loop.yaml -q --tree $tree -o tree.csv
  difference loop.csv tree.csv | awk -v tree=$tree '{ print tree, $1 < 1e-9 ? "the same" : $1 }'
done
say equilibrium loop.yaml -q

echo "-- a jump of a driven rate leaves states as they are"
cat >jump.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
states:
  speed: {rate: (arm.tip.velocity.y - speed)/0.01}
  force: {rate: (5 - 200*arm.tip.deflection.y - 20*speed - force)/0.05, initial: 3, unit: N}
bodies:
  arm: {type: beam, length: 1, elements: 2, E: 7e10, density: 2700, area: 1e-4, Iz: 8e-10, points: {tip: length}, initial: equilibrium}
joints:
  hub: {type: revolute, from: ground, to: arm, motion: "if(t < 0.2, 0, 0.5*(t - 0.2))"}
forces:
  push: {type: force, at: arm.tip, value: [0, force, 0]}
outputs: [force, speed, arm.tip.deflection.y]
simulation: {duration: 0.2, samples: 2, tolerance: 1e-8}
END
"$COTREE" simulate jump.yaml -q -o before.csv && "$COTREE" simulate jump.yaml -q --until 0.2000000001 --samples 2 -o after.csv
paste -d, before.csv after.csv | awk -F, 'NR == 3 { d = $2 - $6; e = $3 - $7; print d * d < 1e-12 && e * e < 1e-12 ? "they stay" : $0 }'

echo "-- what follows from rates"
for rate in slide.a block.acceleration.x slide.force.y energy.kinetic slide.torque.z block.nothing.x; do
  sed "s/rate: setpoint - slide.q/rate: $rate/" position.yaml >wrong.yaml
  say check wrong.yaml 2>&1 | sed -n '/error/p'
done
sed 's/rate: setpoint - slide.q/rate: -100*sign(integral - 0.1)/' position.yaml >chatter.yaml
say simulate chatter.yaml -q -o - 2>&1 | sed -n '/error/p'
sed 's/rate: setpoint - slide.q/rate: 1e3*integral^2, initial: 1/' position.yaml >blows.yaml
say simulate blows.yaml -q -o blows.csv 2>&1 | sed -n 's/([0-9.e-]* s)/(... s)/; /error/p'
for rate in 1/integral "sqrt(-1 - slide.q^2)"; do
  sed "s|rate: setpoint - slide.q|rate: $rate|" position.yaml >undefined.yaml
  say simulate undefined.yaml -q -o undefined.csv 2>&1 | sed -n '/error/p'
done

echo "-- exported C has them behind the speeds"
for model in position loop; do
  "$COTREE" export $model.yaml -o $model.c && (cd $model.c && ${CC:-cc} -std=c99 -Wall -Wextra -Werror -O1 -o self_test ./*.c -lm && ./self_test)
done

# Starts a thousandth of a radian from a singular configuration that move slowly there: outputs are within 10 T, or the run ends
# and says that round-off is what ends it (E308). The references are found by hand: M(th) th'' + M' th'^2/2 + V' = Q
# of the crank's angle on the smooth motion, in 30 digits to 1e-20; that of the kite by DOP853 to 1e-13. In absolute coordinates, of
# which none is given, a start is known no better than their round-off leaves it, which is told.

# angle and rate of the crank, end: links of 0.15 m on 0.4 m, in line at 0
parallelogram() {
  cat <<E
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {c: [0.4, 0, 0]}}
  k: {mass: 0.3, inertia: 1e-3, com: [0.075, 0, 0], points: {p: [0.15, 0, 0]}}
  co: {mass: 0.9, inertia: 7e-3, com: [0.22, 0.05, 0], points: {p: [0.4, 0, 0]}}
  r: {mass: 0.4, inertia: 2e-3, com: [0.075, 0, 0], points: {p: [0.15, 0, 0]}}
joints:
  kj: {type: revolute, from: ground, to: k, effort: 0.2*sin(5*t), initial: {q: $1, u: $2}}
  cj: {type: revolute, from: k.p, to: co, initial: {q: -($1), guess: true}}
  rj: {type: revolute, from: ground.c, to: r, initial: {q: $1, guess: true}}
  cl: {type: revolute, from: co.p, to: r.p}
outputs: [kj.q, kj.u]
simulation: {duration: $3, samples: 51}
E
}

# the same from upright: links of 0.4 m, where the block passes the pin
slider_crank() {
  cat <<E
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  crank: {mass: 1.3, inertia: 1.3*0.4^2/12, com: [0.2, 0, 0], points: {end: [0.4, 0, 0]}}
  rod: {mass: 0.9, inertia: 0.9*0.4^2/12, com: [0.2, 0, 0], points: {end: [0.4, 0, 0]}}
  block: {mass: 0.7, inertia: 0.01}
joints:
  pin: {type: revolute, from: ground, to: crank, initial: {q: pi/2 + ($1), u: $2}}
  elbow: {type: revolute, from: crank.end, to: rod, initial: {q: -pi - 2*($1), guess: true}}
  wrist: {type: revolute, from: rod.end, to: block, initial: {q: pi/2 + ($1), guess: true}}
  slide: {type: prismatic, from: ground, to: block, initial: {q: 0.8*cos(pi/2 + ($1)), guess: true}}
outputs: [pin.q, slide.q]
simulation: {duration: $3, samples: 51}
E
}

# links of 0.12, 0.31, 0.31 m on 0.12 m, all in line at 0
kite() {
  cat <<E
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {c: [0.12, 0, 0]}}
  crank: {mass: 0.5, inertia: 2e-3, com: [0.05, 0, 0], points: {p: [0.12, 0, 0]}}
  coup: {mass: 0.4, inertia: 4e-3, com: [0.17, 0, 0], points: {p: [0.31, 0, 0]}}
  rocker: {mass: 0.6, inertia: 5e-3, com: [0.11, 0, 0], points: {p: [0.31, 0, 0]}}
joints:
  crank_j: {type: revolute, from: ground, to: crank, damping: 0.01, initial: {q: $1, u: $2}}
  coup_j: {type: revolute, from: crank.p, to: coup, initial: {q: -0.69354838*($1), guess: true}}
  rock_j: {type: revolute, from: ground.c, to: rocker, initial: {q: 0.69354838*($1), guess: true}}
  close: {type: revolute, from: coup.p, to: rocker.p}
outputs: [crank_j.q, rock_j.u]
simulation: {duration: $3, samples: 51}
E
}

while read -r mechanism angle rate end values; do
  "$mechanism" "$angle" "$rate" "$end" >model.yaml
  for options in "" "--tree absolute" "--keep-all"; do
    told='^ '
    [ "$options" = "--tree absolute" ] && told='so near to a singular configuration that round-off'
    for T in 1e-4 1e-6 1e-8; do
      # shellcheck disable=SC2086
      "$COTREE" simulate model.yaml --tolerance $T $options --quiet -o out.csv 2>said || { grep -q 'E308' said && continue; }
      grep -v -e '^ ' -e "$told" said
      tail -n 1 out.csv | awk -F, -v wanted="$values" -v name="$mechanism $options" -v T=$T '
        { n = split(wanted, v, " ")
          for (i = 1; i <= n; i++) {
            d = ($(i + 1) - v[i]) / v[i]
            if (!(d * d < 100 * T * T)) print name ": error " d / T " T at " T } }'
    done
  done
  echo "$mechanism at $angle, $rate rad/s"
done <<'E'
parallelogram -1e-3 1 0.5 -2.793612713372265 3.566832265418279
slider_crank 1e-3 -0.01 0.6 1.564859463635946 0.00474946262684709
slider_crank -1e-3 0.5 0.6 1.979818183447556 -0.3181696494466653
kite -5e-4 3 0.5 -4.082308893390746 -2.446417964716699
E

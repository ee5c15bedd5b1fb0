# Starts in a singular configuration with the speeds of one of the motions that go through it. The references are found by hand, with 30
# digits: all places follow from the angle th of the crank (below), the energy gives its rate, and t = int dth/rate.

# bars CRANK COUPLER ROCKER BASE, rates of A and B; all in line along x
four_bar() {
  cat <<E
cotree: 1
parameters: {w: 1}
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {far: [$4, 0, 0]}}
  crank: {mass: 1.3, inertia: 1.3*$1^2/12, com: [$1/2, 0, 0], points: {end: [$1, 0, 0]}}
  coupler: {mass: 0.9, inertia: 0.9*$2^2/12, com: [$2/2, 0, 0], points: {end: [$2, 0, 0], mid: [$2/2, 0, 0]}}
  rocker: {mass: 0.7, inertia: 0.7*$3^2/12, com: [$3/2, 0, 0], points: {end: [$3, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: crank, initial: {q: 0, u: $5*w}}
  B: {type: revolute, from: crank.end, to: coupler, initial: {q: 0, u: ($6)*w}}
  C: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: 0, guess: true}}
  D: {type: revolute, from: ground.far, to: rocker, initial: {q: 0, guess: true}}
outputs: [A.q, coupler.mid.position.x, coupler.mid.position.y, rocker.end.position.x, rocker.end.position.y]
simulation: {duration: 1, samples: 2}
E
}

# links of 0.4 m, the crank upright, the slider at the pin of the crank; rate of the elbow
slider_crank() {
  cat <<E
cotree: 1
parameters: {w: 1}
gravity: [0, -9.81, 0]
bodies:
  crank: {mass: 1.3, inertia: 1.3*0.4^2/12, com: [0.2, 0, 0], points: {end: [0.4, 0, 0]}}
  rod: {mass: 0.9, inertia: 0.9*0.4^2/12, com: [0.2, 0, 0], points: {end: [0.4, 0, 0]}}
  block: {mass: 0.7, inertia: 0.01}
joints:
  pin: {type: revolute, from: ground, to: crank, initial: {q: pi/2, u: 8*w}}
  elbow: {type: revolute, from: crank.end, to: rod, initial: {q: -pi, u: ($1)*w}}
  wrist: {type: revolute, from: rod.end, to: block, initial: {q: pi/2, guess: true}}
  slide: {type: prismatic, from: ground, to: block}
outputs: [pin.q, elbow.q, slide.q]
simulation: {duration: 1, samples: 2}
E
}

# compare MODEL END VALUE...: the last row, where an error over 10 T of the size of all is told
compare() {
  name=$1
  until=$2
  shift 2
  for options in "" "--tree absolute" "--keep-all" "--method radau5"; do
    for T in 1e-4 1e-6 1e-8 1e-10; do
      # shellcheck disable=SC2086
      "$COTREE" simulate "$name.yaml" --until "$until" --tolerance $T $options --quiet -o out.csv 2>out.txt || cat out.txt
      tail -n 1 out.csv | awk -F, -v wanted="$*" -v name="$name $options" -v T=$T '
        { n = split(wanted, v, " "); for (i = 1; i <= n; i++) { d = $(i + 1) - v[i]; s += d * d; q += v[i] * v[i] }
          if (!(sqrt(s / q) < 10 * T)) print name ": error " sqrt(s / q) / T " T at " T }'
    done
  done
  echo "$name"
}

# a parallelogram: the rocker turns as the crank does, or tan(D/2) = -3 tan(th/2), the antiparallelogram
four_bar 1 2 1 2 8 -8 >parallel.yaml
four_bar 1 2 1 2 8 -24 >anti.yaml
compare parallel 1 7.6377428287872402134 1.2145575477106361952 0.97671134872100164043 2.2145575477106361952 0.97671134872100164043
compare anti 1 13.853080359614827347 0.80517278270848261111 0.10874924323082492245 1.3300648039588992373 -0.74241958022763104455
# bars of one length, and no weight: the crank turns evenly, in long steps, through in-line positions
four_bar 1 1 1 1 8 -8 | sed '/^gravity/d' >even.yaml
compare even 2 16 -0.4576594803233847 -0.2879033166650653 0.0423405196766153 -0.2879033166650653
# bars of 1, 2, 1.5 m on a base of 1.5 m: from w1 + 2 w2 = 1.5 w3, w1^2 + 2 w2^2 = 1.5 w3^2 the rates are w3/w1 = -2 +- sqrt(8)
four_bar 1 2 1.5 1.5 8 '8*((1.5*(sqrt(8)-2)-1)/2-1)' >one.yaml
four_bar 1 2 1.5 1.5 8 '8*((1.5*(-sqrt(8)-2)-1)/2-1)' >other.yaml
compare one 1 6.6915854691999309835 1.2357631115375638146 -0.55094720977685663534 1.5537688638652700378 -1.4990359933232550831
compare other 0.25 7.4642413231736423777 1.3681321575662926215 1.0782803679990460218 2.3563161017194380352 1.2315529765040662075
# equal links: the slider moves by 2 L cos(pin), or stays where it is and both links turn as one
slider_crank -16 >moves.yaml
slider_crank 0 >stays.yaml
compare moves 1 13.652527707655057123 -27.305055415310114245 0.37271133442448861246
compare stays 1 12.886539305156352344 -3.1415926535897932385 0

echo '-- the configuration is reported, and members of a sweep go the same way'
"$COTREE" simulate anti.yaml --quiet --summary s.json -o out.csv 2>out.txt
sed -n 's/.*"time": //p' s.json | tr -d , | awk '{ printf "%s%.4f", (NR > 1 ? " " : ""), $1 } END { print "" }'
"$COTREE" sweep stays.yaml --vary w=0.9:1.1:3 --quiet -o out.csv 2>out.txt
cut -d, -f1,3,4,6 out.csv | sed 's/\(\.[0-9]\{4\}\)[0-9]*/\1/g'

echo '-- at rest nothing tells which motion is meant; other speeds belong to none; fixed steps do not lead away'
four_bar 1 2 1 2 0 0 >rest.yaml
four_bar 1 2 1 2 8 -7 >none.yaml
for run in rest none 'anti --step 0.001' 'stays --step 0.001'; do
  # shellcheck disable=SC2086
  set -- $run
  name=$1
  shift
  "$COTREE" simulate "$name.yaml" "$@" --quiet -o out.csv 2>&1 | grep -v -e warning -e '^ ' -e 'stays open' | sed 's/t = [0-9.e-]*[1-9][0-9.e-]*/t = T/'
done

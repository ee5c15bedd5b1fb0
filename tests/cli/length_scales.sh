# A slider-crank whose rod is longer than its crank by a thousandth and by a part of 1e-5, with links of metres down to micrometres: loops are
# closed to a part of them. Angles and rates at 4 s by extrapolation in long double from the same equations by hand, which know no length but that.
cat >model.yaml <<'E'
cotree: 1
parameters: {size: 1, part: 1e-3, r: 0.3*size, l: r*(1 + part)}
gravity: [0, -9.81*size, 0]
bodies:
  crank: {mass: 1.5, inertia: 0.5*size^2, com: [0.1*size, 0, 0], points: {e: [r, 0, 0]}}
  rod: {mass: 0.6, inertia: 0.01*size^2, com: [l/2, 0, 0], points: {e: [l, 0, 0]}}
  slide: {mass: 2}
joints:
  k: {type: revolute, from: ground, to: crank, initial: {q: 0.5, u: 6}}
  c: {type: revolute, from: crank.e, to: rod, initial: {q: -1, guess: true}}
  s: {type: prismatic, from: ground, to: slide, axis: x, initial: {q: 0.5*size, guess: true}}
  w: {type: revolute, from: rod.e, to: slide}
outputs: [k.q, k.u, {name: rod.q, value: k.q + c.q}]
simulation: {duration: 4, samples: 2}
E
while read -r part values; do
  for size in 1 1e-2 1e-4 1e-6; do
    for options in "" "--tree absolute" "--method radau5"; do
      for T in 1e-6 1e-8 1e-10; do
        # shellcheck disable=SC2086
        "$COTREE" simulate model.yaml --set "size=$size" --set "part=$part" --tolerance $T $options --quiet -o out.csv
        tail -n 1 out.csv | awk -F, -v wanted="$values" -v name="$part, $size m $options" -v T=$T '
          { n = split(wanted, v, " "); for (i = 1; i <= n; i++) { d = $(i + 1) - v[i]; s += d * d; q += v[i] * v[i] }
            if (!(sqrt(s / q) < 10 * T)) print name ": error " sqrt(s / q) / T " T at " T }'
      done
    done
  done
  echo "$part"
done <<'E'
1e-3 25.62304622224331471 6.032400450504250188 -0.4897718226401060423
1e-5 25.52863269424671081 6.350032754337920292 -0.3958872859874347229
E
# members of a sweep side by side close their loops as each alone
"$COTREE" sweep model.yaml --vary size=1e-6:1e-4:4 --tolerance 1e-10 --quiet -o out.csv
cut -d, -f3-5 out.csv | sed 's/\(\.[0-9]\{7\}\)[0-9]*/\1/g'
# A rod longer than its crank by 0.3 nm, which no closing of 1e-9 m tells from one as long: the guide goes on counting, just.
for options in "" "--method dopri5" "--method radau5" "--tree absolute"; do
  for T in 1e-4 1e-6; do
    # shellcheck disable=SC2086
    "$COTREE" simulate model.yaml --set part=1e-9 --tolerance $T $options --quiet -o out.csv
    tail -n 1 out.csv | awk -F, -v wanted="25.51712961199328792 6.388424399195954017 -0.3843883828704318632" -v name="1e-9 $options" -v T=$T '
      { n = split(wanted, v, " "); for (i = 1; i <= n; i++) { d = $(i + 1) - v[i]; s += d * d; q += v[i] * v[i] }
        if (!(sqrt(s / q) < 10 * T)) print name ": error " sqrt(s / q) / T " T at " T }'
  done
done

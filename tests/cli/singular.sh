# Singular positions passed, in the ledger and in the summary; of spatial rows most are redundant.
cat >parallelogram.yaml <<'END'
cotree: 1
name: parallelogram
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {b: [1, 0, 0]}}
  left: {mass: 1, inertia: 0.0834, com: [0, 0.5, 0], points: {end: [0, 1, 0]}}
  right: {mass: 1, inertia: 0.0834, com: [0, 0.5, 0], points: {end: [0, 1, 0]}}
  coupler: {mass: 1, inertia: 0.0834, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: left, initial: {q: 0, u: -1}}
  b: {type: revolute, from: ground.b, to: right, initial: {q: 0, guess: true}}
  c: {type: revolute, from: left.end, to: coupler, initial: {q: 0, guess: true}}
  d: {type: revolute, from: coupler.end, to: right.end, initial: {q: 0, guess: true}}
outputs: [a.q]
simulation: {duration: 4, tolerance: 1e-8}
END
for options in "" --keep-all "--tree joints" "--tree absolute"; do
    echo "-- $options"
    # shellcheck disable=SC2086
    "$COTREE" simulate parallelogram.yaml --summary s.json $options 2>out
    sed -n '/^singular/,/^seconds/p' out | grep -v '^seconds' | sed 's/\(t = [0-9.]\{5\}\)[0-9]*/\1/'
    grep -o '"rank_loss": .*' s.json | sort | uniq -c | tr -s ' '
    sed -n 's/.*"time": //p' s.json | tr -d , | awk '{ printf "%s%.4f", (NR > 1 ? " " : ""), $1 } END { print "" }'
done

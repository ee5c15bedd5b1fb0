# simulate --verify: the estimate is near the true error, is in the summary, and says when a chaotic motion is lost;
# auto says why it takes an implicit method.
. "$(dirname "$0")/lib.sh"
# `asked`: the largest error of the angle estimated in s.json; `true`: against quarter periods, where it is zero
estimate() { sed -n "/\"$1\": {/,/}/s/.*\"absolute\": \(.*\),/\1/p" s.json; }

echo '-- fixed steps: after a quarter of the exact period the pendulum hangs down'
m=$SYSTEMS/pendulum/model.yaml
for method in rk4 dopri5 radau5 generalized-alpha newmark; do
  "$COTREE" simulate "$m" -o r.csv --quiet --method "$method" --step 0.01 --until 0.591960486894059 \
    --samples 2 --verify --summary s.json
  awk -F, -v e="$(estimate pivot.q)" -v method="$method" 'NR == 3 {
    t = $2 < 0 ? -$2 : $2
    if (t < 3 * e && e < 3 * t) print method, "is estimated well"; else print method, "errs by", t, "not", e }' r.csv
done
echo '-- without it there is no estimate'
"$COTREE" simulate "$m" -o r.csv --quiet --summary s.json
grep -E '"(global|compared_with|verify)"' s.json
echo '-- the line of the summary'
"$COTREE" simulate "$m" -o r.csv --verify 2>&1 | sed -n '/^global/{s/[0-9.]*e-[0-9]*/NUMBER/;s/ in [^,]*,/ in OUTPUT,/;s/(.*)/(...)/;p}'
echo '-- a chaotic motion is lost'
"$COTREE" simulate "$SYSTEMS/double_pendulum/model.yaml" -o r.csv --until 60 --samples 61 --tolerance 1e-6 --verify 2>&1 |
  awk '/^note: more/ { print ($(NF - 1) > 5 && $(NF - 1) < 40) ? "not before 5 s, not after 40 s" : $0 }'
echo '-- a stiff spring: the implicit method takes over'
"$COTREE" simulate "$SYSTEMS/stiff_spring_pendulum/model.yaml" -o r.csv --set k=1e8 --until 2 --tolerance 1e-4 \
  --summary s.json 2>&1 | sed -n '/^method/{s/, but.*radau5 from the start: .*/, but radau5 begins/;p}'
sed -n 's/^  "method": //p' s.json
echo '-- a soft one: it does not'
"$COTREE" simulate "$SYSTEMS/stiff_spring_pendulum/model.yaml" -o r.csv --quiet --set k=1e3 --tolerance 1e-4 --summary s.json
sed -n 's/^  "method": //p' s.json
echo '-- and in loops, past the time event'
sed 's/stiffness: 60$/stiffness: 6e8/; s/damping: 4$/damping: 4e7/' "$SYSTEMS/governor/model.yaml" >governor.yaml
"$COTREE" simulate governor.yaml -o r.csv --quiet --tolerance 1e-5 --verify --summary s.json
sed -n 's/^  "method": //p' s.json
awk -F': ' '/"global"|"energy_drift"/ { print $1, ($2 + 0 < 1e-4 ? "below 1e-4" : $2) }' s.json
awk -F'[:,]' '/"steps"/ { print ($2 < 5000 ? "few steps" : $2) }' s.json
echo '-- where both runs are held to the rounding of the force, the second one is looser'
"$COTREE" simulate "$SYSTEMS/stiff_spring_pendulum/model.yaml" -o r.csv --quiet --set k=1e8 --until 1 --tolerance 1e-10 --verify --summary s.json
awk -F'[:,]' '/"global"/ { print ($2 > 1e-9 && $2 < 1e-6 ? "of the size of the vibration that is lost" : $2) }' s.json

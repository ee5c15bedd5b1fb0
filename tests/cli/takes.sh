# What a sweep takes over runs: against closed forms, fine samples and runs alone; events, switches, implicit methods;
# resumed, in shards, and what cannot be taken.
. "$(dirname "$0")/lib.sh"

# x = cos(w t): extremes, means and zeros are known
cat >vibration.yaml <<'END'
cotree: 1
parameters: {k: 4}
bodies: {b: {mass: 1}}
joints: {j: {type: prismatic, axis: x, from: ground, to: b, effort: -k*j.q, initial: {q: 1}}}
outputs: [j.q]
simulation: {duration: 10, samples: 3}
END
known() { # FACTOR OPTION...: largest difference from what is known is below FACTOR times the tolerance
  factor=$1
  shift
  "$COTREE" sweep vibration.yaml --quiet --vary k=1:9:5 -o known.csv --take 'peak=max(j.u)' --take 'low=min(j.a)' \
    --take 'mean=mean(j.q)' --take 'rms=rms(j.q)' --take 'end=final(j.u)' --take 'at=time(j.u)' \
    --take 'size=mean(abs(j.u))' --take 'zero=min(abs(j.q))' --take 'never=time(j.q - 2)' \
    --take 'late=mean(if(t > pi, 1, 0))' --take 'then=time(if(t > pi, 1, -1))' --take 'both=max(-j.q^2)' "$@"
  awk -F, -v factor="$factor" 'NR > 1 {
    w = sqrt($2); T = 10; pi = 3.14159265358979
    whole = int(w*T/pi); phase = w*T - whole*pi
    check("peak", $4, w, w); check("low", $5, -w*w, w*w)
    check("mean", $6, sin(w*T)/(w*T), 1); check("rms", $7, sqrt(1/2 + sin(2*w*T)/(4*w*T)), 1)
    check("end", $8, -w*sin(w*T), w); check("at", $9, pi/w, 1)
    check("size", $10, (2*whole + 1 - cos(phase))/T, w); check("zero", $11, 0, 1)
    if ($12 != "") print "never: " $12
    check("late", $13, (T - pi)/T, 1); check("then", $14, pi, 1); check("both", $15, 0, 1)
    if ($16 != 0) print "failed"
  }
  function check(name, is, wanted, size) {
    d = is - wanted; if (d < 0) d = -d
    if (!(d <= factor*1e-8*size)) print "k = " $2 ": " name " is " is ", not " wanted
  }
  END { if (NR != 6) print NR " rows" }' known.csv
}
known 1 && head -1 known.csv
known 1 --method dopri5
known 1 --lanes 1
known 1 --lanes 8
known 1 --backend tape
known 1 --method radau5
known 1000 --method generalized-alpha --tolerance 1e-5
known 100 --method rk4 --step 0.01

# lanes, threads and shards: the same bytes
taken() { "$COTREE" sweep vibration.yaml --quiet --vary k=1:9:11 --take 'peak=max(j.u)' --take 'at=time(j.q - 0.5)' "$@"; }
taken -o one.csv --threads 1
taken -o two.csv --threads 2 --lanes 8
cmp one.csv two.csv && echo "the same bytes"
for i in 1 2 3; do taken -o part$i.csv --shard $i/3; done
"$COTREE" merge merged.csv part?.csv && cmp merged.csv one.csv && echo "the same bytes"
grep -E '^(output|take)' part1.csv.settings
taken -o never.csv --take 'never=time(j.q - 2)' --resume
head -5 never.csv >again.csv.partial
mv never.csv.settings again.csv.partial.settings
taken -o again.csv --take 'never=time(j.q - 2)' --resume --summary s.json
cmp again.csv never.csv && grep resumed s.json
taken -o never.json --take 'never=time(j.q - 2)' && grep -A2 '"never"' never.json | tr -d ' \n'; echo

# against the samples of `simulate`: fine ones come near to extremes, from within
samples() { # SYSTEM UNTIL SIGNAL
  "$COTREE" simulate "$1" --quiet --until "$2" --set "${vary%%:*}" --samples 20001 -o - |
    awk -F, -v name="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i; next }
      { v = $c; if (NR == 2 || v > most) most = v; if (NR == 2 || v < least) least = v; sum += v * (NR == 2 || NR == 20002 ? 0.5 : 1) }
      END { printf "%.12g,%.12g,%.12g\n", most, least, sum/20000 }'
}
near() { # SYSTEM UNTIL SIGNAL [NAME]: most, least and mean, in lanes and alone
  model=$SYSTEMS/$1/model.yaml
  [ -f "$model" ] || model=$1/model.yaml
  samples "$model" "$2" "${4:-$3}" >want
  for lanes in 1 4; do
    "$COTREE" sweep "$model" --quiet --until "$2" --vary "$vary" -o near.csv --lanes $lanes --summary s.json \
      --take "most=max($3)" --take "least=min($3)" --take "mean=mean($3)"
    tail -1 near.csv | awk -F, -v want="$(cat want)" -v what="$1 $3, lanes $lanes" '{
      split(want, w, ","); most = $(NF-3); least = $(NF-2); size = w[1] - w[2]
      bad = most < w[1] - 1e-7*size || most > w[1] + 1e-4*size || least > w[2] + 1e-7*size || least < w[2] - 1e-4*size
      d = $(NF-1) - w[3]; if (d < 0) d = -d
      if (bad || d > 1e-4*size) print what ": " most " " least " " $(NF-1) ", samples " want; else print what ": near"
    }'
  done
}
vary=r='152 mm:152 mm:1'
near slider_crank 1 guide.a a
near slider_crank 1 guide.force.y side_force
vary=b=0.3:0.3:1
near four_bar 1 rocker_pin.u rocker_speed
vary=T=1.5:1.5:1
near puma560_driven 1 j2.effort torque2
# events: what jumps has both its sides
mkdir -p stopped
cat >stopped/model.yaml <<'END'
cotree: 1
parameters: {k: 1e4}
gravity: [0, -9.81, 0]
bodies: {ball: {mass: 1}}
joints:
  j: {type: prismatic, from: ground, to: ball, axis: y, initial: {q: 1}, effort: "if(j.q < 0, 200 - k*j.q - 5*j.u, 0)"}
outputs: [j.q, j.u, j.a]
simulation: {duration: 3}
END
vary=k=1e4:1e4:1
near stopped 2 j.a
near stopped 2 j.q
"$COTREE" sweep stopped/model.yaml --quiet --vary k=1e4:1e4:1 --take 'hit=time(-j.q)' --take 'push=time(j.a)' --until 1 -o - |
  awk -F, 'NR == 2 { d = $6 - sqrt(2/9.81); e = $7 - $6; print (d*d + e*e < 1e-16) ? "the first hit" : $0 }'

# a run of no length; a value that is not finite
"$COTREE" sweep stopped/model.yaml --quiet --vary k=1e4:1e4:1 --set k=1 --take 'm=mean(j.q)' --take 'r=rms(-j.q)' --until 1e-9 -o - | cut -d, -f6,7
"$COTREE" sweep vibration.yaml --quiet --vary k=1:4:2 --take 'bad=max(sqrt(j.q))' -o - --summary s.json
grep message s.json

bad() { say sweep vibration.yaml --vary k=1:4:2 -o no.csv "$@"; }
bad --take 'max(j.q)'
bad --take 'peak=j.q'
bad --take 'peak=most(j.q)'
bad --take 'peak=max(j.q'
bad --take 'peak=max(j.q) + max(j.u)'
bad --take 'peak=max(j.z)'
bad --take 'peak=max(j.q, j.u)'
bad --take 'j.q=max(j.q)'
bad --take 'run=max(j.q)'
bad --take 'k=max(j.q)'
bad --take 'a=max(j.q)' --take 'a=min(j.q)'
bad --take '=max(j.q)'

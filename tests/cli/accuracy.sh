# Speed against error: the table, its errors, the answer to --error, references that fit and that do not.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
"$COTREE" accuracy "$m" --until 2 --samples 101 --error 1e-7 --plot plot.svg >table 2>summary || echo "exit $?"
head -n 1 table
echo '-- methods, and how many settings of each'
cut -d, -f1 table | sed 1d | uniq -c | awk '{ print $2, $1 }'
echo '-- errors fall with the tolerance, down to rounding; all fields are there'
awk -F, '
  NR > 1 && NF != 8 { print "fields:", $0 }
  NR > 1 && !($6 > 0 && $7 > 0 && $8 > 0 && $3 == "" && $4 == "") { print "odd:", $0 }
  NR > 1 && $1 == method && !($5 + 0 < error + 0 || $5 + 0 < 1e-10) { print "does not fall:", $0 }
  $1 ~ /^dop/ && !($5 != "" && $5 + 0 < $2 + 0) { print "larger than wanted:", $0 }
  { method = $1; error = $5 }' table
echo '-- the reference is known better than what is asked'
sed -n 's|^reference  *\(.*\): they differ by \(.*\)$|\1 \2|p' summary | awk '{ print (/checked with/ ? "two runs" : "?"), ($NF < 1e-9 ? "agree" : "differ") }'
echo '-- the cheapest setting that meets the error, as the table has it'
setting=$(sed -n 's/^cheapest .* 1e-07: method \([a-z0-9-]*\), [a-z]* \([^:]*\): .*/\1 \2/p' summary)
awk -F, -v setting="$setting" '
  NR > 1 && $5 != "" && $5 + 0 <= 1e-7 && (best == "" || $6 + 0 < least + 0) { best = $1 " " $2; least = $6 }
  END { print best == setting ? "is named" : "best " best " named " setting }' table
grep -c '<polyline' plot.svg
tail -n 1 plot.svg
echo '-- none meets it'
"$COTREE" accuracy "$m" --until 2 --samples 101 --method generalized-alpha --tolerance 1e-3 --error 1e-9 2>&1 >/dev/null |
  sed -n 's/^cheapest  *\(.*\); .*/\1/p'
echo '-- one method, its steps; the same in JSON'
"$COTREE" accuracy "$m" --until 2 --samples 101 --method rk4 --step 0.01 -o one.csv --quiet
cut -d, -f1,2,7,8 one.csv
"$COTREE" accuracy "$m" --until 2 --samples 101 --method rk4 --step 0.01 -o one.json --quiet
sed -n -e '/"tolerance"/p' -e '/"steps"/p' one.json
echo '-- a finer ladder, of two digits each'
"$COTREE" accuracy "$m" --until 1 --samples 2 --method dop853 --per-decade 3 -o fine.csv --quiet
cut -d, -f2 fine.csv | sed -n '2,6p;$p'
echo '-- the automatic choice beside others'
"$COTREE" accuracy "$SYSTEMS/stiff_spring_pendulum/model.yaml" --until 0.2 --samples 3 --method radau5,auto --tolerance 1e-4 -o auto.csv --quiet
cut -d, -f1,2 auto.csv
"$COTREE" simulate "$SYSTEMS/stiff_spring_pendulum/model.yaml" --until 0.2 --samples 3 --tolerance 1e-4 -o run.csv --summary run.json --quiet
awk -F, 'NR == FNR { if ($1 ~ /"steps"/) { split($1, v, ": "); steps = v[2] + 0 } next } $1 == "auto" { print $7 == steps ? "the steps of simulate" : $7 " steps, " steps " of simulate" }' run.json auto.csv
rm auto.csv run.csv run.json
echo '-- and of fixed steps, of any method: errors fall with the order'
"$COTREE" accuracy "$m" --until 1 --samples 2 --method dopri5,rk4 --step 0.1 --per-decade 2 -o fine.csv --quiet
cut -d, -f1,2,7 fine.csv
awk -F, 'NR > 2 && $1 == method && !($5 < 0.02 * error || $5 < 1e-13) { print "falls too little:", $0 } { method = $1; error = $5 }' fine.csv
echo '-- of closed loops, too, with no more evaluations than they have stages'
"$COTREE" accuracy "$SYSTEMS/four_bar/model.yaml" --until 1 --samples 2 --method rk4,dop853 --step 0.01 --quiet | cut -d, -f1,7,8
say accuracy "$m" --per-decade 11
say accuracy "$m" --elements 1,2
say accuracy "$m" --formulations linear
rm fine.csv
echo '-- a reference from a file'
"$COTREE" simulate "$m" --until 2 --samples 101 --tolerance 1e-11 --quiet -o reference.csv
"$COTREE" accuracy "$m" --until 2 --samples 101 --method dop853 --tolerance 1e-9 --reference reference.csv 2>summary |
  awk -F, 'NR == 2 { print $1, $2, ($5 > 0 && $5 < 1e-9 ? "small" : $5) }'
sed -n -e '/^reference/p' -e 's/^cheapest *\(for an error of [^:]*\):.*/\1, where none is given/p' summary
cut -d, -f1,2 reference.csv >some.csv
"$COTREE" accuracy "$m" --until 2 --samples 101 --method dop853 --tolerance 1e-9 --reference some.csv 2>&1 >/dev/null |
  sed '/^cheapest/d'
echo '-- errors against the largest value of the reference, also where there are no samples'
awk -F, 'NR < 3 || NR == 102 { print; next } { print $1 ",1000" }' some.csv >large.csv
"$COTREE" accuracy "$m" --until 2 --samples 2 --method dop853 --tolerance 1e-2 --reference large.csv --quiet |
  awk -F, 'NR == 2 { print ($5 < 1e-7 ? "small" : $5) }'
rm large.csv
echo '-- and such as do not fit'
sed '1s/pivot\.q/elbow.q/' some.csv >wrong.csv
say accuracy "$m" --reference wrong.csv
sed '1s/^t/time/' some.csv >wrong.csv
say accuracy "$m" --reference wrong.csv
printf 't,pivot.q\n0.0123,1\n' >wrong.csv
say accuracy "$m" --reference wrong.csv
printf 't,pivot.q\n0,one\n' >wrong.csv
say accuracy "$m" --reference wrong.csv
say accuracy "$m" --reference missing.csv
echo '-- wrong options'
say accuracy "$m" --error 0
say accuracy "$m" --method dopri5,dopri6
say simulate "$m" --error 1e-6
ls
echo '-- what the elements of a beam leave: tighter tolerances are not tried in vain, and the cheapest is named'
cat >arm.yaml <<'END'
cotree: 1
name: arm
gravity: [0, -9.81, 0]
bodies:
  arm: {type: beam, length: 1.4, elements: 3, E: 70e9, density: 2700, area: 2e-4, Iz: 1.7e-9, points: {tip: length}}
joints:
  hub: {type: revolute, from: ground, to: arm, initial: {q: 0.3}}
outputs:
  - {name: tip, value: arm.tip.deflection.y}
simulation: {duration: 0.05, samples: 11}
END
"$COTREE" accuracy arm.yaml --elements 1 --method dopri5 --error 1e-6 >table 2>summary || echo "exit $?"
sed 1d table | wc -l
awk -F, -v setting="$(sed -n 's/^cheapest .* the nearest is method dopri5, N = 1, tolerance \([^:]*\): .*/\1/p' summary)" '
  NR > 1 && (best == "" || $6 + 0 < least + 0) { best = $2 + 0; least = $6 }
  END { print best == setting + 0 ? "is named" : "best " best " named " setting }' table

echo '-- what no explicit method gets through: the reference is radau5 with two tolerances'
cat >stiff.yaml <<'END'
cotree: 1
bodies: {block: {mass: 1}}
joints: {slide: {type: prismatic, from: ground, to: block, stiffness: 1e6, damping: 2e6, initial: {q: 1}}}
outputs: [slide.q]
simulation: {duration: 5000, samples: 11}
END
"$COTREE" accuracy stiff.yaml --method radau5 --tolerance 1e-5 2>summary >table
sed -n 's/^reference *\(.*\): they differ by [0-9.e-]*$/\1/p' summary
echo '-- a force of which radau5 loses a vibration of 9e-8 at any tolerance is checked by an explicit method'
"$COTREE" accuracy "$SYSTEMS/stiff_spring_pendulum/model.yaml" --set k=1e8 --until 1 --method radau5 --tolerance 1e-5 2>summary >table
sed -n 's/^reference .*\(checked with dopri5\).*/\1/p' summary

# The first steps in quadruple precision overflow, which is no agreement: nothing has the error 0.
echo '-- a damper that long steps are far too long for'
cat >damper.yaml <<'END'
cotree: 1
bodies: {a: {mass: 1, inertia: 0.1}}
joints: {s: {type: prismatic, from: ground, to: a, initial: {q: 2, u: 0.1}, effort: "-250*s.u - 1e4*s.u^3"}}
outputs: [s.q]
simulation: {duration: 36, samples: 2}
END
"$COTREE" accuracy damper.yaml --method dopri5 --tolerance 1e-4 --quiet -o damper.csv
awk -F, 'NR > 1 { print ($5 > 0 && $5 < 1e-4 ? "an error" : $5) }' damper.csv

# simulate --input: a table plays inputs, linear between its rows or held; and what is wrong with one.
. "$(dirname "$0")/lib.sh"

cat >mass.yaml <<'END'
cotree: 1
inputs:
  push: {value: 7, unit: N}
  angle: {value: 0.5, unit: deg}
bodies:
  block: {mass: 2}
joints:
  slide: {type: prismatic, from: ground, to: block, effort: push}
outputs: [slide.q, slide.u, push, angle]
simulation: {duration: 4, samples: 5, tolerance: 1e-10}
END
printf 't [ms],push [kN]\n0,0\n1000,0.002\n3000,-0.004\n4000,0\n' >push.csv

# x'' = push/2 integrated by hand: u and x at whole seconds
printf 't,slide.q,slide.u,push\n0,0,0,0\n1,0.16666666666666666,0.5,2\n2,0.9166666666666666,0.75,-1\n3,1.1666666666666667,-0.5,-4\n4,0,-1.5,0\n' >linear.csv
printf 't,slide.q,slide.u,push\n0,0,0,0\n1,0,0,2\n2,0.5,1,2\n3,2,2,-4\n4,3,0,0\n' >held.csv
for how in linear held; do
  [ $how = held ] && hold=--hold || hold=
  for method in auto radau5 generalized-alpha; do
    "$COTREE" simulate mass.yaml --input push.csv $hold --method $method -q -o run.csv
    cut -d, -f1-4 run.csv >four.csv
    difference $how.csv four.csv | awk -v how="$how $method" '{ print how ": " ($1 < 1e-8 ? "as by hand" : $1) }'
  done
done

echo "-- a row counts from its t on: before the first one the value of the model, after the last one that row"
printf 't,push\n1,2\n2,-1\n' >late.csv
"$COTREE" simulate mass.yaml --input late.csv --hold -q -o - | cut -d, -f1,4
echo "-- units, and a column without one"
printf 't,angle [rad]\n0,1\n4,2\n' >units.csv
"$COTREE" simulate mass.yaml --input units.csv -q -o - | cut -d, -f1,5
printf 't,angle\n0,1\n4,2\n' >units.csv
say simulate mass.yaml --input units.csv -q -o run.csv

echo "-- what is wrong"
wrong() {
  printf "$1" >wrong.csv
  say simulate mass.yaml --input wrong.csv -q -o run.csv $2
}
wrong 'time,push\n0,1\n4,2\n'
wrong 't,psh,block,push,push [N]\n0,1,1,1,1\n4,2,1,1,1\n'
wrong 't,push [m]\n0,1\n4,2\n'
wrong 't [N],push\n0,1\n4,2\n'
wrong 't,push\n0,1\n2,\n4,2\n'
wrong 't,push\n0,1\n2,3\n2,2\n'
wrong 't,push\n0,1\n2\n'
wrong 't,push\n0,1\n'
wrong 't,push\n'
wrong 't,push\n1,1\n4,1\n'
wrong 't,push\n0,1\n3,1\n'
say simulate mass.yaml --input missing.csv -q -o run.csv
say simulate mass.yaml --hold -q -o run.csv
say simulate mass.yaml --input push.csv --set push=1 -q -o run.csv
sed 's/mass: 2/mass: "1 + push"/' mass.yaml >heavy.yaml
say simulate heavy.yaml --input push.csv -q -o run.csv
sed 's/effort: push/motion: push/' mass.yaml >driven.yaml
say simulate driven.yaml --input push.csv --hold -q -o run.csv

# a file that is read is not written; sources have inputs that are set, and none that are played
say simulate mass.yaml --input push.csv -q -o push.csv
say export mass.yaml --input push.csv -o source
say sweep mass.yaml --vary push=0:1:2 --hold

# what is played is no input of the linearised model, where it would have no effect
say linearize mass.yaml --input push.csv -q
say linearize mass.yaml --input push.csv --inputs push -q

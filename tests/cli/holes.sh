# What a model may not do to the machine of who reads it.
. "$(dirname "$0")/lib.sh"
model() { # model TABLE
  cat <<END
cotree: 1
bodies: {b: {mass: 1, inertia: 1}}
joints:
  j: {type: revolute, from: ground, to: b, effort: {table: $1, column: x}}
outputs: [j.q]
simulation: {duration: 0.1, samples: 2}
END
}

echo '-- tables that never end'
mkfifo fifo
model fifo >t.yaml
say check t.yaml
model /dev/zero >t.yaml
say check t.yaml
say accuracy "$SYSTEMS/pendulum/model.yaml" --reference fifo

echo '-- an error in a table shows where, not what'
printf 't,x\n0,1\n1,secret and more\n' >secret
printf 't,x\n0,1\n"secret\n' >open
model secret >t.yaml
say check t.yaml
model open >t.yaml
say check t.yaml

echo '-- names steer no terminal'
printf 'cotree: 1\nname: "\\e[31mred"\nbodies: {b: {mass: 1}}\n' >n.yaml
say check n.yaml | tr -d '\033'
printf 'cotree: 1\nname: two\ndescription: "a\\u009b31m"\nbodies: {b: {mass: 1}}\n' >n.yaml
say check n.yaml | head -2
printf 'cotree: 1\nbodies: {b: {mass: 1, inertia: 1}}\njoints: {j: {type: revolute, from: ground, to: b}}\n' >"$(printf 'r\033[31m.yaml')"
"$COTREE" check "$(printf 'r\033[31m.yaml')" 2>&1 | head -1 | od -c

echo '-- messages end'
{
  echo 'cotree: 1'
  echo 'bodies:'
  awk 'BEGIN { for (i = 0; i < 5000; i++) print "  b" i ": {mas: 1}" }'
} >many.yaml
"$COTREE" check many.yaml >out 2>&1
echo "exit $?: $(grep -c error: out) errors"
tail -1 out

echo '-- a long expression on a small stack'
for operator in + - '*'; do
  awk -v o="$operator" 'BEGIN {
    e = "t"
    for (i = 1; i < 8000; i++) e = e o "t"
    print "cotree: 1\nbodies: {b: {mass: 1, inertia: 1}}\njoints:\n  j: {type: revolute, from: ground, to: b, effort: \"" e "\"}"
    print "outputs: [j.q]\nsimulation: {duration: 0.1, samples: 2}"
  }' >long.yaml
  for command in simulate check 'equations --format c' 'equations --format latex' 'modes'; do
    (
      ulimit -s 512
      "$COTREE" $command long.yaml >/dev/null 2>&1
    )
    status=$?
    [ $status -eq 0 ] || echo "$operator $command: exit $status"
  done
done

echo '-- a damaged cell is not taken over'
sweep() { "$COTREE" sweep "$SYSTEMS/slider_crank/model.yaml" --quiet --until 0.1 --vary torque=0.4:0.6:4 -o c.csv --resume; }
sweep
for damage in '3s/,\([0-9.]*\),/,\1#,/' '3s/\([0-9]\),0$/\1\1.,0/' '3s/,[^,]*,0$/,,0/' '3s/,0$/,1/' '3s/,0$/,00/'; do
  sed "$damage" c.csv >c.csv.partial
  cmp -s c.csv c.csv.partial && echo "no damage: $damage"
  cp c.csv.settings c.csv.partial.settings
  mv c.csv kept
  sweep 2>&1
  echo "exit $?"
  mv kept c.csv
done

echo '-- without memory: 1'
(
  ulimit -v 30000
  "$COTREE" check "$SYSTEMS/chain40/model.yaml" >/dev/null 2>said
  [ $? -eq 1 ] || echo "exit $?: $(cat said)"
)

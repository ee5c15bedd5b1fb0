# FMUs of FMI 2.0 and 3.0 in an importer of ours: their motions are those of `simulate`, in model exchange and co-simulation.
. "$(dirname "$0")/../cli/lib.sh"

# near A B MOST: largest difference of columns of the same names against the largest number of each, columns that are zero but
# for round-off left out
near() {
  awk -F, -v most="$3" '
    FNR == 1 { nfile++ }
    nfile == 1 && FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; n = NF; next }
    nfile == 2 && FNR == 1 { for (i = 1; i <= NF; i++) if ($i in column) of[i] = column[$i]; else bad = 1; bad = bad || NF != n; next }
    nfile == 1 { for (i = 1; i <= NF; i++) { value[FNR, i] = $i; if (size($i) > largest[i]) largest[i] = size($i) } rows = FNR }
    nfile == 2 { for (i = 1; i <= n; i++) { d = size($i - value[FNR, of[i]])
        if (largest[of[i]] > 1e-6 && d / largest[of[i]] > worst) worst = d / largest[of[i]] } }
    function size(x) { return x < 0 ? -x : x }
    END { if (bad || FNR != rows) print "different shapes"
          else print (worst <= most ? "as simulated" : "differs by " worst) }' "$1" "$2"
}

# motion NAME MODEL UNTIL STEP OF MODEL EXCHANGE [OPTIONS]: of both versions and kinds, held to ten times the tolerance
motion() {
  name=$1 model=$2 until=$3 step=$4
  shift 4
  ROWS=7
  export ROWS
  "$COTREE" simulate "$model" --quiet --until "$until" --samples 8 --tolerance 1e-7 "$@" -o run.csv
  for version in 2 3; do
    "$COTREE" export "$model" --format fmu$version --tolerance 1e-7 "$@" -o "$name$version.fmu"
    "$IMPORTER" "$name$version.fmu" cs 0.001 "$until" >cs.csv
    "$IMPORTER" "$name$version.fmu" me "$step" "$until" >me.csv
    echo "$name, FMI $version: co-simulation $(near run.csv cs.csv 1e-6), model exchange $(near run.csv me.csv 1e-6)"
  done
}

cat >ball.yaml <<'E2'
cotree: 1
name: ball
parameters: {m: 0.2, stiffness: 2000, damping: 0.05*sqrt(stiffness*m)}
gravity: [0, 0, -9.81]
bodies: {ball: {type: particle, mass: m}}
joints:
  height:
    type: prismatic
    from: ground
    to: ball
    axis: z
    initial: {q: 0.5}
    effort: "if(height.q < 0, -stiffness*height.q - damping*height.u, 0) - 0.02*abs(height.u)*height.u"
outputs:
  - height.q
  - height.u
  - height.a
  - {name: contact, value: "if(height.q < 0, 1, 0)"}
simulation: {duration: 1}
E2
cat >crank.yaml <<'E2'
cotree: 1
name: crank
parameters: {l: 0.5, speed: 2, m: 1}
inputs: {tau: 0.3}
gravity: [0, -9.81, 0]
bodies:
  crank: {mass: m, com: [l/2, 0, 0], inertia: m*l^2/12, points: {tip: [l, 0, 0]}}
  rod: {mass: 2*m, com: [l, 0, 0], inertia: 2*m*l^2/3}
joints:
  drive: {type: revolute, from: ground, to: crank, motion: "if(t < 0.33, 0, speed*(t - 0.33))"}
  pin: {type: revolute, from: crank.tip, to: rod, initial: {q: -0.2}, effort: "tau - 0.1*pin.u"}
outputs: [pin.q, pin.u, pin.a, drive.effort, pin.force]
simulation: {duration: 1}
E2
cat >pid.yaml <<'E2'
cotree: 1
name: pid
parameters: {Ki: 3, Kp: 10, Kd: 2, setpoint: 0.5}
states:
  integral: {rate: "setpoint - arm.q", initial: 0.2, unit: rad*s}
  filter: {rate: "(arm.u - filter)/0.05", initial: 0}
gravity: [0, -9.81, 0]
bodies: {link: {mass: 1, com: [0.3, 0, 0], inertia: 0.05}}
joints:
  arm: {type: revolute, from: ground, to: link, effort: "Kp*(setpoint - arm.q) + Ki*integral - Kd*filter"}
outputs: [arm.q, arm.u, {name: twice, value: 2*integral}]
simulation: {duration: 2, samples: 201}
E2
printf 't,angle\n0,0\n0.2537,0.4\n0.5031,-0.2\n0.8013,0\n2,0\n' >ramp.csv
sed 's/name: crank/name: tabled/; s/motion: "[^"]*"/motion: {table: ramp.csv, column: angle, interpolate: linear}/' crank.yaml >tabled.yaml

motion cart_pole "$SYSTEMS/cart_pole/model.yaml" 3 0.001
motion puma560 "$SYSTEMS/puma560/model.yaml" 1 0.001
motion slider_crank "$SYSTEMS/slider_crank/model.yaml" 1 0.0002
motion flexible_manipulator "$SYSTEMS/flexible_manipulator/model.yaml" 0.35 0.00002
motion heavy_top "$SYSTEMS/heavy_top/model.yaml" 0.5 0.0001
motion ball ball.yaml 1 0.0001
motion crank crank.yaml 1 0.001
motion tabled tabled.yaml 1 0.001
motion pid pid.yaml 1 0.001
echo '-- other trees'
motion absolute "$SYSTEMS/slider_crank/model.yaml" 0.5 0.0002 --tree absolute

echo '-- values that are set; derived parameters follow'
"$COTREE" simulate ball.yaml --quiet --until 1 --samples 8 --tolerance 1e-7 --set stiffness=500 -o run.csv
"$IMPORTER" ball3.fmu cs 0.001 1 stiffness=500 >set.csv
near run.csv set.csv 1e-6
"$COTREE" simulate crank.yaml --quiet --until 1 --samples 8 --tolerance 1e-7 --set tau=-1 --set l=0.4 -o run.csv
"$IMPORTER" crank2.fmu me 0.001 1 tau=-1 l=0.4 >set.csv
near run.csv set.csv 1e-6
"$IMPORTER" ball3.fmu cs 0.001 1 damping=1 2>&1 | head -2

for version in 2 3; do
  for name in puma560 slider_crank heavy_top ball crank pid; do
    echo "-- states, derivatives, refusals: $name, FMI $version"
    "$IMPORTER" $name$version.fmu check
  done
done

echo '-- what is inside, the same bytes again'
for version in 2 3; do
  "$COTREE" export crank.yaml --format fmu$version --tolerance 1e-7 -o one.fmu
  cmp one.fmu crank$version.fmu
  mkdir inside$version
  "$IMPORTER" one.fmu unpack inside$version
  for cc in gcc clang; do
    command -v $cc >/dev/null || cc=cc
    (cd inside$version/sources && $cc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -c -o fmu.o fmu.c)
  done
  ! command -v xmllint >/dev/null || xmllint --noout inside$version/modelDescription.xml
  sed -n '/<ModelStructure>/,$p' inside$version/modelDescription.xml
done
grep -E 'causality="(input|parameter|calculatedParameter)"' inside3/modelDescription.xml

echo '-- without a compiler; words'
PATH=/nowhere "$COTREE" export ball.yaml --format fmu3 -o sources.fmu 2>&1
"$IMPORTER" sources.fmu unpack sources
say export ball.yaml --format fmu1 -o ball.fmu
say export ball.yaml --format fmu3 -o no/such/ball.fmu

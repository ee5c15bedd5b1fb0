# A row of a sweep is what `simulate --set` gives: closed and open systems, redundant rows, beams, switches and tables
# in lanes, implicit methods, trees, members that lock or cannot be assembled.
. "$(dirname "$0")/lib.sh"

# check SYSTEM UNTIL VARY OPTION...: says how many members, how many failed, and every difference
check() {
  m=$1 until=$2 vary=$3
  shift 3
  "$COTREE" sweep "$m" --quiet --until "$until" --vary "$vary" -o rows.csv --summary rows.json "$@"
  : >differences
  sed 1d rows.csv | while IFS=, read -r run value rest; do
    status=0
    "$COTREE" simulate "$m" --quiet --until "$until" --set "${vary%%=*}=$value" -o run.csv "$@" 2>/dev/null || status=1
    [ "${rest##*,}" = $status ] || echo "run $run: status ${rest##*,}, alone $status" >>differences
    [ $status = 0 ] || continue
    same_row "$run" "${rest%,*}" >>differences
  done
  echo "$(basename "$(dirname "$m")") $vary $*: $(number members) members," \
    "$(number failed) failed, lanes $(number lanes), alone $(number alone)"
  cat differences
}
number() { awk -v name="\"$1\":" '$1 == name { print $2 + 0 }' rows.json; }

# same_bytes MODEL UNTIL VARY: however many threads and lanes
same_bytes() {
  "$COTREE" sweep "$1" --quiet --until "$2" --vary "$3" -o one.csv --threads 1
  "$COTREE" sweep "$1" --quiet --until "$2" --vary "$3" -o two.csv --threads 2 --lanes 8
  cmp one.csv two.csv && echo "the same bytes"
}

check "$SYSTEMS/four_bar/model.yaml" 1.5 b=0.3:1.1:5
check "$SYSTEMS/four_bar/model.yaml" 0.5 a=0.18:0.22:2 --method radau5
check "$SYSTEMS/four_bar/model.yaml" 0.2 a=0.18:0.22:2 --method generalized-alpha --step 0.001
check "$SYSTEMS/four_bar_near_singular/model.yaml" 1.5 d=0.99:0.9999:3
check "$SYSTEMS/slider_crank/model.yaml" 0.5 l=0.1:0.2:3
check "$SYSTEMS/slider_crank/model.yaml" 0.3 r=0.12:0.16:2 --keep-all
check "$SYSTEMS/slider_crank/model.yaml" 0.3 r=0.12:0.16:2 --tree absolute
check "$SYSTEMS/stewart/model.yaml" 0.3 k=6000:9000:2
check "$SYSTEMS/double_pendulum/model.yaml" 1 m2=-0.5:1:3
check "$SYSTEMS/tapered_cantilever/model.yaml" 0.02 load=500:1500:2
check "$SYSTEMS/slider_crank_flexible/model.yaml" 0.02 r=0.14:0.16:2
check "$SYSTEMS/puma560_driven/model.yaml" 0.3 T=1:2:2
mkdir -p bouncing
cat >bouncing/model.yaml <<'END'
cotree: 1
parameters: {h: 1, k: 1e4, c: 5}
gravity: [0, -9.81, 0]
bodies: {ball: {mass: 1}}
joints:
  j: {type: prismatic, from: ground, to: ball, axis: y, initial: {q: h}, effort: "if(j.q < 0, -k*j.q - c*j.u, 0)"}
outputs: [j.q, j.u, energy.total]
simulation: {duration: 3}
END
check bouncing/model.yaml 2 k=1e3:1e5:3
same_bytes bouncing/model.yaml 2 k=1e3:1e5:9
# at rest until a short push
mkdir -p struck
cat >struck/model.yaml <<'END'
cotree: 1
parameters: {at: 8}
gravity: [0, -9.81, 0]
bodies: {bar: {mass: 1, inertia: 0.02, com: [0, -0.3, 0]}}
joints:
  j: {type: revolute, from: ground, to: bar, damping: 0.1, effort: "9*exp(-((t - at)/0.03)^2)"}
outputs: [j.q, j.u]
simulation: {duration: 10}
END
check struck/model.yaml 10 at=3:9:4
# a loop with a stop and dry friction, switched by time, too
mkdir -p stopped
sed 's/guide: {type: prismatic,/& effort: "-if(guide.u > 0, f, -f) - if(guide.q < 0.2, 4000*(guide.q - 0.2), 0) + if(t > 0.25, 20, 0)",/
  s/^  torque: .*/&\n  f: 3/' "$SYSTEMS/slider_crank/model.yaml" >stopped/model.yaml
check stopped/model.yaml 0.5 f=1:5:5
same_bytes stopped/model.yaml 0.5 f=1:5:9
# what is held by friction is no motion that f describes: alone, with the reason
mkdir -p held
cat >held/model.yaml <<'END'
cotree: 1
parameters: {f: 1}
bodies: {block: {mass: 1}}
joints: {j: {type: prismatic, from: ground, to: block, axis: x, initial: {u: 1}, effort: "if(j.u > 0, -f, f) + 0.5"}}
outputs: [j.q, j.u]
simulation: {duration: 3}
END
check held/model.yaml 3 f=0.2:2:4
# tables, smooth ones and those with kinks; beyond the end of a table no member goes on
mkdir -p table
awk 'BEGIN { print "t,angle"; for (i = 0; i <= 12; i++) printf "%.17g,%.17g\n", i/4, 0.3*sin(i/2) }' >table/angle.csv
for kind in cubic linear; do
  mkdir -p "table/$kind"
  cat >"table/$kind/model.yaml" <<END
cotree: 1
gravity: [0, -9.81, 0]
parameters: {l: 0.5, end: 2}
bodies:
  crank: {mass: 2, com: [0.1, 0, 0], inertia: 0.01, points: {tip: [0.2, 0, 0]}}
  rod: {mass: 1, com: [l/2, 0, 0], inertia: 0.02}
joints:
  a: {type: revolute, from: ground, to: crank, motion: {table: ../angle.csv, column: angle, interpolate: $kind}}
  b: {type: revolute, from: crank.tip, to: rod, initial: {q: 0.4}}
outputs: [a.q, a.u, b.q, b.u, a.effort, energy.work]
simulation: {duration: end}
END
  check "table/$kind/model.yaml" 2 l=0.3:0.6:6 --tolerance 1e-10
done
check_end() { "$COTREE" sweep "table/$1/model.yaml" --quiet --vary end=2.5:3.5:3 -o rows.csv && cut -d, -f1,2,9 rows.csv; }
check_end cubic

# Line drawings: well-formed, the same bytes each time, with the symbols of the joints and the names of all.
. "$(dirname "$0")/lib.sh"

# A file that an XML parser takes; where there is none, one root that is closed.
well_formed() {
  if command -v xmllint >/dev/null; then
    xmllint --noout "$1" || echo "$1: not well-formed"
  elif [ "$(head -c 4 "$1")" != '<svg' ] || [ "$(tail -n 1 "$1")" != '</svg>' ]; then
    echo "$1: no SVG"
  fi
}

# Groups of each kind.
kinds() {
  sed -n 's/^<g class="\([^"]*\)".*/\1/p' "$1" | sort | uniq -c | awk '{ n = $1; $1 = ""; print n " x" $0 }'
}

echo '-- all systems'
for model in "$SYSTEMS"/*/model.yaml; do
  "$COTREE" draw "$model" -o a.svg 2>/dev/null || echo "$model: exit $?"
  "$COTREE" draw "$model" >b.svg 2>/dev/null
  cmp a.svg b.svg
  well_formed a.svg
done

echo '-- slider-crank'
m=$SYSTEMS/slider_crank/model.yaml
say draw "$m" -o s.svg
kinds s.svg
sed -n 's/^<text .*class="name".*>\(.*\)<\/text>/\1/p' s.svg | sort
grep -c 'scale' s.svg
echo '-- stewart'
"$COTREE" draw "$SYSTEMS/stewart/model.yaml" -o p.svg && kinds p.svg

echo '-- each joint'
cat >joints.yaml <<'END'
cotree: 1
name: "</title><script>alert('1')</script> & \"quoted\" \x01 \u202E"
gravity: [0, 0, -9.81]
parameters: {m: 1}
bodies:
  ground: {points: {a: [1, 0, 0], b: [2, 0, 0], c: [3, 0, 0], d: [4, 0, 0], e: [5, 0, 0], f: [6, 0, 0]}}
  on_screw: &part {mass: m, inertia: 1, com: [0, 0, 0.3]}
  on_cylinder: *part
  on_plane: *part
  on_custom: *part
  welded: *part
  ball: *part
  free_one: *part
  bob: {type: particle, mass: m}
joints:
  j1: {type: screw, from: ground, to: on_screw, pitch: 0.1}
  j2: {type: cylindrical, from: ground.a, to: on_cylinder}
  j3: {type: planar, from: ground.b, to: on_plane}
  j4: {type: custom, from: ground.c, to: on_custom, coordinates: [s], translate: [s, s^2, 0]}
  j5: {type: weld, from: ground.d, to: welded}
  j6: {type: spherical, from: ground.e, to: ball}
  j7: {type: free, from: ground, to: free_one, initial: {q: [0, 2, 0, 1, 0, 0, 0]}}
  j8: {type: distance, from: ground.f, to: bob}
  j9: {type: free, from: ground, to: bob, initial: {q: [6, 0, -1]}}
forces:
  spring: {type: spring, from: ground, to: free_one, stiffness: 1, damping: 1, length: 1}
  push: {type: force, at: free_one, value: [0, 1, 0]}
  turn: {type: torque, on: free_one, value: [1, 0, 0]}
END
say draw joints.yaml -o j.svg
well_formed j.svg
kinds j.svg
sed -n 's/^<title>\(.*title.*\)<\/title>/\1/p' j.svg

echo '-- later, paths, views'
say draw "$m" --time 0.5 -o t.svg
grep -o 't = [0-9.]* s' t.svg
say draw "$m" --time 0 -o t0.svg
cmp s.svg t0.svg
say draw "$m" --trace -o r.svg
sed -n '/class="traces"/,/^<\/g>/p' r.svg | grep -c '<path'
for view in x y z iso; do
  say draw "$m" --view $view -o $view.svg
  well_formed $view.svg
done
cmp s.svg z.svg
echo '-- a beam bends'
# the tip of a cantilever that hangs in its equilibrium lies below its root
cat >beam.yaml <<'END'
cotree: 1
gravity: [0, -10, 0]
bodies:
  beam: {type: beam, length: 1, elements: 2, mass_per_length: 1, E: 1, area: 1e6, Iz: 5, initial: equilibrium}
joints:
  clamp: {type: weld, from: ground, to: beam}
END
say draw beam.yaml -o beam.svg
# the axis as steps: pixels down and along, in tenths; the theory of a clamped beam says w L^4/(8 E I) = 0.25 L
sed -n '/class="body beam"/,/^<\/g>/s/.*d="M[-0-9]* [-0-9]*l\([-0-9 ]*\)".*/\1/p' beam.svg | head -n 1 |
  tr ' ' '\n' | awk 'NR % 2 { x += $1; next } { y += $1 } END { printf "%.2f\n", y / x }'

echo '-- mistakes'
say draw "$m" --view front
say draw "$m" --time 1 --trace
say draw "$m" --time -1
say draw "$m" --time soon
say draw "$m" -o /nowhere/s.svg
ls ./*.partial 2>/dev/null || echo "no partial file"

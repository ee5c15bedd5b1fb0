# Shapes of bodies: text and binary STL files give the same picture, boxes are hidden where they are behind, parameters count.
. "$(dirname "$0")/lib.sh"
# a tetrahedron, its faces counterclockwise from outside
cat >text.stl <<'END'
solid corner
facet normal 0 0 -1
  outer loop
    vertex 0 0 0
    vertex 0 1 0
    vertex 1 0 0
  endloop
endfacet
FACET NORMAL nan nan nan
  outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 1 endloop
endfacet
facet normal -1 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet
facet normal 1 1 1 outer loop vertex 1 0 0 vertex 0 1e+0 0 vertex 0 0 1.0 endloop endfacet
endsolid corner
END
float() { # 0 or 1, little-endian
  case $1 in 0) printf '\000\000\000\000' ;; 1) printf '\000\000\200\077' ;; esac
}
{
  printf '%-80s' 'solid in name only'
  printf '\004\000\000\000'
  for corners in '0 0 0 0 1 0 1 0 0' '0 0 0 1 0 0 0 0 1' '0 0 0 0 0 1 0 1 0' '1 0 0 0 1 0 0 0 1'; do
    for x in 0 0 0 $corners; do float $x; done
    printf '\000\000'
  done
} >binary.stl
wc -c <binary.stl | tr -d ' '
model() {
  cat <<END
cotree: 1
name: shapes
parameters: {a: 0.3}
bodies:
  ground: {shape: {box: [3, 3, 0.1], at: [0, 0, -1], color: lightgray}}
  part:
    mass: 1
    inertia: 1
    shape:
$1
joints: {pin: {type: revolute, from: ground, to: part, axis: x}}
END
}
faces() { sed -n '/data-component="part"/,/^<\/g>/p' "$1" | grep -c 'fill="#[0-9a-f]* *'; }
for kind in text binary; do
  model "      {file: $kind.stl, scale: a, at: [0, 0, 1], rotate: [z, pi/4], color: '#fa0'}" >$kind.yaml
  say draw $kind.yaml -o $kind.svg
  faces $kind.svg
done
cmp text.svg binary.svg
model '      - {box: [a, 2*a, 3*a], color: red}
      - {cylinder: [a, 1], axis: [1, 1, 0], at: [1, 0, 0], color: teal}
      - {sphere: a, at: [0, 1, 0]}
      - {lines: [[0, 0, 0], [0, 0, 1], [1, 0, 1]], color: "#00000f"}' >all.yaml
say draw all.yaml -o all.svg
say draw all.yaml --set a=0.4 -o large.svg
cmp -s all.svg large.svg && echo 'the parameter has no effect'
command -v xmllint >/dev/null && xmllint --noout all.svg
# seen along z a box shows its top alone, a sphere its outline, a line has no face
model '      {box: [1, 1, 1]}' >box.yaml
for view in z iso; do "$COTREE" draw box.yaml --view $view -o v.svg && faces v.svg; done
grep -c 'fill="none" stroke="#00000f"' all.svg
# a shape has no say in the motion
"$COTREE" check all.yaml | head -n 3

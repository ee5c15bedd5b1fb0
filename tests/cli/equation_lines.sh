# Equations of motion of beams stay readable: lines that `equations --show reduced` prints, none of them over 100 columns.
. "$(dirname "$0")/lib.sh"

# NAME MODEL MOST: equations of a model take at most so many lines.
within() {
  "$COTREE" equations "$2" --show reduced >lines
  n=$(wc -l <lines)
  [ "$n" -le "$3" ] && echo "$1: within $3 lines" || echo "$1: $n lines, more than $3"
  awk 'length($0) > 100 { print "wide: " $0 }' lines
}

m=$SYSTEMS/slider_crank_flexible/model.yaml
sed 's/formulation: foreshortening/formulation: linear/' "$m" >linear.yaml
within 'slider-crank, linear beams' linear.yaml 80
within 'slider-crank, foreshortening' "$m" 80
within 'two booms in a plane' "$SYSTEMS/two_boom_satellite/model.yaml" 60
sed 's/planar/free/; s/  n: 2/  n: 1/
  s/^    Iz: 2e-9/&\n    Iy: 2e-9\n    deformation: [axial, bending-y, bending-z]/' \
  "$SYSTEMS/two_boom_satellite/model.yaml" >space.yaml
within 'two booms in space, one element each' space.yaml 300
sed 's/  n: 1/  n: 2/' space.yaml >space2.yaml
within 'two booms in space, two elements each' space2.yaml 300
within 'right-angle frame' "$SYSTEMS/right_angle_frame/model.yaml" 1200

echo '-- of beams that differ by their names alone one is written out'
"$COTREE" equations "$SYSTEMS/two_boom_satellite/model.yaml" --show terminal | grep -A1 '^beam boom2'
"$COTREE" equations space.yaml --show terminal | grep -A4 '^beam boom2'

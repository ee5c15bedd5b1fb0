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
s=$SYSTEMS/two_boom_satellite/space.yaml
within 'two booms in space' "$s" 300
within 'right-angle frame' "$SYSTEMS/right_angle_frame/model.yaml" 1200

echo '-- of beams that differ by their names alone one is written out'
for name in two_boom_satellite/model two_boom_satellite/space right_angle_frame/model slider_crank_flexible/model; do
  "$COTREE" equations "$SYSTEMS/$name.yaml" --show terminal >terminal
  echo "$name: $(grep -c '^matrices of' terminal) of $(grep -c '^beam' terminal)"
  grep '^  as beam' terminal || true
done

# The derivation of small systems: all stages of two, trees and reduced equations of the others.
for s in pendulum slider_crank; do
  "$PRINT_EQUATIONS" "$SYSTEMS/$s/model.yaml" all text >"$s.txt"
  "$PRINT_EQUATIONS" "$SYSTEMS/$s/model.yaml" all latex >"$s.tex"
done
for s in cart_pole double_pendulum four_bar tumbling_body; do
  "$PRINT_EQUATIONS" "$SYSTEMS/$s/model.yaml" tree,reduced text >"$s.txt"
done
"$PRINT_EQUATIONS" "$SYSTEMS/governor/model.yaml" terminal,reduced text >governor.txt
"$PRINT_EQUATIONS" "$SYSTEMS/pendulum/model.yaml" all json >pendulum.json
"$PRINT_EQUATIONS" "$SYSTEMS/pendulum/model.yaml" tree,reduced html >pendulum.html
"$PRINT_EQUATIONS" "$SYSTEMS/slider_crank/model.yaml" reduced c >slider_crank.c.txt
# beams: one element with all its terms, from two trees; several elements that foreshorten
p="$SYSTEMS/pendulum_beam_tip_mass/model.yaml"
"$PRINT_EQUATIONS" "$p" all text >pendulum_beam.txt
"$PRINT_EQUATIONS" "$p" all latex >pendulum_beam.tex
"$PRINT_EQUATIONS" "$p" terminal,reduced html >pendulum_beam.html
"$PRINT_EQUATIONS" "$p" terminal,reduced json >pendulum_beam.json
"$PRINT_EQUATIONS" "$p" tree,cutset,circuit,reduced text absolute >pendulum_beam_absolute.txt
"$PRINT_EQUATIONS" "$SYSTEMS/spin_up_beam/model.yaml" terminal text >spin_up_beam.txt
# long ones: the elastic coordinates of each beam as one vector
for s in slider_crank_flexible two_boom_satellite; do
  "$PRINT_EQUATIONS" "$SYSTEMS/$s/model.yaml" reduced text >"$s.txt"
done

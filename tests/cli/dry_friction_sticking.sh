# Dry friction comes to rest where its sign switches: the run says so and leaves no result, whatever the method;
# smoothed, it comes to rest.
. "$(dirname "$0")/lib.sh"
cat >cart.yaml <<'END'
cotree: 1
bodies:
  cart: {mass: 1}
joints:
  slide: {type: prismatic, from: ground, to: cart, initial: {u: 1}, effort: "-3*sign(slide.u)"}
outputs: [slide.u]
simulation: {duration: 3, samples: 4}
END
for method in dopri5 dop853 radau5; do
  "$COTREE" simulate cart.yaml --method $method -o cart.csv --quiet 2>&1
  echo "exit $?"
done
sed 's/-3\*sign(slide.u)/1 - 3*sign(slide.u)/; s/u: 1}/u: 0}/' cart.yaml >rest.yaml
"$COTREE" simulate rest.yaml --quiet 2>&1 | head -1
sed 's/-3\*sign(slide.u)/-3*tanh(slide.u\/0.001)/' cart.yaml >smooth.yaml
"$COTREE" simulate smooth.yaml --quiet
awk -F, 'END { u = $2 + 0; print (u < 1e-6 && u > -1e-6) ? "at rest" : $2 }' smooth.csv # to awk 4e-309 as it stands is a text
ls

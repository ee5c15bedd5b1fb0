# simulate --plot: panels by unit, round ticks, a legend; the CSV is what it is without.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/slider_crank/model.yaml
texts() { sed -n 's/^<text[^>]*>\(.*\)<\/text>$/\1/p' "$1"; }

say simulate "$m" -q --until 0.5 -o plain.csv
say simulate "$m" -q --until 0.5 -o run.csv --plot run.svg
cmp plain.csv run.csv
say simulate "$m" -q --until 0.5 -o run.csv --plot again.svg
cmp run.svg again.svg
command -v xmllint >/dev/null && xmllint --noout run.svg
texts run.svg
grep -c '<g class="line"' run.svg

echo '-- some columns, names that XML and lists do not like'
cat >hostile.yaml <<'END'
cotree: 1
name: "a < b & \"c\" </svg>"
bodies:
  cart: {mass: 1}
joints:
  slide: {type: prismatic, from: ground, to: cart, stiffness: 1e6, initial: {q: 1e-5}}
outputs:
  - {name: "max(slide.q, 0)", value: "max(slide.q, 0)"}
  - {name: "<b>&\"x\"</b>", value: 2*slide.u}
  - {name: a column with a name that is too long for the legend of a plot, value: slide.q*slide.u}
  - {name: "nothing", value: 0*slide.q}
  - energy.total
simulation: {duration: 0.01, samples: 11}
END
say simulate hostile.yaml -q -o h.csv --plot h.svg
command -v xmllint >/dev/null && xmllint --noout h.svg
texts h.svg
say simulate hostile.yaml -q -o h.csv --plot some.svg --columns 'max(slide.q, 0), energy.total'
grep -c '<g class="line"' some.svg

echo '-- mistakes'
rm -f run.csv
say simulate "$m" -q -o run.csv --plot no.svg --columns x,crank_angel
say simulate "$m" -q -o run.csv --columns x
say simulate "$m" -q -o run.csv --until 0.01 --plot /nowhere/no.svg
ls run.csv no.svg 2>&1 | sed 's/.*cannot access/cannot access/'

# The stages and formats of the derivation.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
say equations "$m" --show reduced
for format in latex html c json; do
  "$COTREE" equations "$m" --format $format -o a.txt
  case $format in latex) suffix=tex ;; *) suffix=$format ;; esac
  "$COTREE" equations "$m" -o b.$suffix
  cmp a.txt b.$suffix && echo "$format"
done

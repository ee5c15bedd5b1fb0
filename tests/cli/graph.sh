# The graph in each format; the suffix of -o says the format.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
say graph "$m"
"$COTREE" graph "$m" -o g.dot && head -n 1 g.dot
"$COTREE" graph "$m" -o g.json && head -n 1 g.json
echo '-- without Graphviz'
PATH=/nowhere "$COTREE" graph "$m" -o g.svg 2>&1 || echo "exit $?"
if command -v dot >/dev/null; then
  "$COTREE" graph "$m" -o g.svg && grep -c '</svg>' g.svg
else
  echo 1
fi
ls *.dot *.json *.partial 2>&1 | sed 's/.*cannot access/cannot access/'

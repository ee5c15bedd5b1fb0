# Branches by name: the same motion, and mistakes with their place.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/slider_crank/model.yaml
printf 'translation: [main, big_end, guide]\nrotation: [main, big_end, guide]\n' >joints.yaml
"$COTREE" check "$m" --tree joints.yaml | grep -E '^(tree|branches|coordinates)'
for tree in auto joints absolute joints.yaml; do
  "$COTREE" simulate "$m" --tree $tree --quiet --until 0.5 --tolerance 1e-10 -o r.csv
  [ -f first.csv ] || cp r.csv first.csv
  difference first.csv r.csv | awk -v tree=$tree '{ print tree, ($1 < 1e-8) ? "same motion" : $0 }'
done
printf 'translation: [main, big_ned, guide]\nrotations: [main]\n' >wrong.yaml
say check "$m" --tree wrong.yaml
printf 'translation: [main, big_ned, guide]\n' >wrong.yaml
say check "$m" --tree wrong.yaml
printf 'translation: [main, big_end]\n' >wrong.yaml
say check "$m" --tree wrong.yaml
printf 'translation: main\n' >wrong.yaml
say check "$m" --tree wrong.yaml
printf -- '- main\n' >wrong.yaml
say check "$m" --tree wrong.yaml
: >wrong.yaml
say check "$m" --tree wrong.yaml

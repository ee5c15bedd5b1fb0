# --until keeps the spacing of the model, --samples sets the number; each method and a fixed step do run.
m=$SYSTEMS/pendulum/model.yaml
show() {
  "$COTREE" simulate "$m" -o r.csv --quiet "$@" && echo "$* -> $(($(wc -l <r.csv) - 1)) rows," \
    "$(sed -n '3p' r.csv | cut -d, -f1) ... $(tail -n 1 r.csv | cut -d, -f1)"
}
show --until 1
show --until 0.125
show --until 1 --samples 5
show --samples 3
for method in auto dopri5 dop853 rk4; do
  show --method "$method" --step 0.01 --until 1 --samples 2
  cut -d, -f9 r.csv | awk 'NR == 2 { e = $1 } NR == 3 { d = $1 - e; print (d < 1e-6 && d > -1e-6) ? "energy kept" : "energy lost" }'
done

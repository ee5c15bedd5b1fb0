# A wrong command line: exit 2, nothing on standard output, a name that is near.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
say
say simlate "$m"
say sim "$m"
say hlep
say "$m"
say simulate
say simulate "$m" "$m"
say simulate "$m" --tolernce 1e-9
say simulate "$m" --tol 1e-9
say simulate "$m" --out x.csv
say simulate "$m" --vary l=1:2:3
say simulate "$m" --tolerance
say simulate "$m" --tolerance small
say simulate "$m" --step=-1
say simulate "$m" --samples 1
say simulate "$m" --samples 2.5
say simulate "$m" --quiet=yes
say simulate "$m" --backend tap
say simulate "$m" --method dopri6
say simulate "$m" --method euler
say simulate "$m" --method radau
say simulate "$m" --tree jonts
say graph "$m" --format gif
say graph "$m" --show tree
say equations "$m" --format tex
say equations "$m" --show tree,cutsets -o e.txt
say components "$m"
say schema -x
say completion
say completion bas
say completion bash zsh
"$COTREE" simulate "$m" --until 2>/dev/null
cp "$m" own.yaml
say simulate own.yaml -o ./own.yaml
cmp "$m" own.yaml
say simulate own.yaml -o one --summary one
rm own.yaml
ls

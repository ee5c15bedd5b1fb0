# Shards of a sweep: the same rows, merged to the same bytes; parts that do not fit are named; members from a file; two
# that write the same file.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/slider_crank/model.yaml
sweep() { "$COTREE" sweep "$m" --quiet --until 0.1 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' "$@"; }

sweep -o all.csv
for i in 1 2 3 4; do sweep -o "$i.csv" --shard "$i/4" --threads 1; done
for i in 1 2 3 4; do sed 1d "$i.csv" | cut -d, -f1 | tr '\n' ' '; done; echo
"$COTREE" merge merged.csv 3.csv 1.csv 4.csv 2.csv && cmp merged.csv all.csv && echo "the same bytes"
sed -n '/^shard/p' 2.csv.settings
"$COTREE" merge - ?.csv | cmp - all.csv && echo "the same bytes"
# more shards than members
for i in $(seq 11); do sweep -o "many$i.csv" --shard "$i/11" --threads 1; done
wc -l <many11.csv
"$COTREE" merge many.csv many?.csv many1?.csv && cmp many.csv all.csv && echo "the same bytes"
# random members, and members that fail
drawn() { "$COTREE" sweep "$m" --quiet --until 0.02 --vary m3=-0.5:0.5 --sample 7 --seed 2 "$@"; }
drawn -o drawn.csv
for i in 1 2 3; do drawn -o "drawn$i.csv" --shard "$i/3"; done
"$COTREE" merge drawn_merged.csv drawn[123].csv && cmp drawn_merged.csv drawn.csv && echo "the same bytes"
cut -d, -f1,13 drawn.csv | tr '\n' ' '; echo
# a shard that was cut off goes on
head -2 2.csv >2.csv.partial
printf '6,0.3,' >>2.csv.partial
mv 2.csv.settings 2.csv.partial.settings
mv 2.csv whole.csv
say merge no.csv 1.csv 2.csv 3.csv 4.csv
sweep -o 2.csv --shard 2/4 --resume --summary s.json
cmp 2.csv whole.csv && grep -E '"(shards?|resumed)"' s.json

# parts that do not fit
say merge no.csv 1.csv 3.csv 4.csv
cp all.csv earlier.csv
! "$COTREE" merge earlier.csv 1.csv 3.csv 4.csv 2>failed.log && cmp earlier.csv all.csv && echo "an earlier file is as it was"
rm earlier.csv failed.log
say merge no.csv 1.csv
say merge no.csv 1.csv 2.csv 3.csv 4.csv 2.csv
say merge no.csv 1.csv 2.csv 3.csv missing.csv
say merge no.csv all.csv 1.csv
cp 2.csv other.csv
other() { sweep -o other.csv --shard 2/4 "$@"; say merge no.csv 1.csv other.csv 3.csv 4.csv; }
other --tolerance 1e-6
other --set m3=1
sweep -o other.csv --shard 2/5
say merge no.csv 1.csv other.csv 3.csv 4.csv
{ cat "$m"; echo; } >model.yaml
"$COTREE" sweep model.yaml --quiet --until 0.1 --vary torque=0.1:0.5:3 --vary r=0.14:0.16:3 -o other.csv --shard 2/4
say merge no.csv 1.csv other.csv 3.csv 4.csv
sweep -o other.csv --shard 2/4
damaged() { sed "$1" 2.csv >other.csv; say merge no.csv 1.csv other.csv 3.csv 4.csv | grep -v '|'; }
damaged '$d'
damaged '2s/,0$//'
damaged '2p'
damaged '1s/torque/moment/'
head -c -1 2.csv >other.csv
say merge no.csv 1.csv other.csv 3.csv 4.csv | grep -v '|'
rm other.csv.settings
say merge no.csv 1.csv other.csv 3.csv 4.csv
say merge 1.csv 1.csv 2.csv 3.csv 4.csv
say merge no.json 1.csv 2.csv 3.csv 4.csv
say merge no.csv
ls no.* 2>/dev/null
for s in 0/2 3/2 1 1/ /2 1/x; do say sweep "$m" --vary r=0.14:0.16:3 --shard $s; done
say sweep "$m" --vary r=0.14:0.16:3 --shard 1/2 -o no.json
say sweep "$m" --vary r=0.14:0.16:3 --shard 1/2 -o -
sweep --shard 1/2 && ls ./*of*

# members from a file
cut -d, -f2,3 all.csv >members.csv
members() { "$COTREE" sweep "$m" --quiet --until 0.1 --members "$@"; }
members members.csv -o listed.csv && cmp listed.csv all.csv && echo "the same bytes"
for i in 1 2; do members members.csv -o "listed$i.csv" --shard "$i/2" --summary s.json; done
"$COTREE" merge both.csv listed[12].csv && cmp both.csv all.csv && echo "the same bytes"
sed -n '/"vary"/,/]/p' s.json | tr -d ' \n'; echo
sed '2s/.*/0.2,150 mm/' members.csv >changed.csv
members changed.csv -o listed2.csv --shard 2/2
say merge no.csv listed1.csv listed2.csv
sed -n '2p' changed.csv
members changed.csv -o - | sed -n 2p | cut -d, -f1-3
bad() { printf "$1" >bad.csv; say sweep "$m" --members bad.csv -o no.csv; }
bad 'torque,r\n0.1\n'
bad 'torque,q\n0.1,1\n'
bad 'torque\nfast\n'
bad 'torque\ninf\n'
bad 'r,r\n0.1,0.1\n'
bad 'r\n'
say sweep "$m" --members none.csv -o no.csv
say sweep "$m" --members members.csv --vary r=0.14:0.16:3 -o no.csv

# another one writes the file
locked() { flock "$1" sh -c '. "$0"; shift; say "$@"' "$CASE/lib.sh" "$@"; }
CASE=$(dirname "$0")
locked all.csv.partial sweep "$m" --until 0.1 --vary r=0.14:0.16:3 --quiet -o all.csv
locked merged.csv.partial merge merged.csv 1.csv 2.csv 3.csv 4.csv
cmp merged.csv all.csv && echo "as before"
# two at once: the second one is refused, or both are whole
for i in 1 2 3 4 5; do
  rm -f twice.csv*
  sweep -o twice.csv 2>log1 & one=$!
  sweep -o twice.csv 2>log2; two=$?
  wait $one; one=$?
  cmp twice.csv all.csv || echo "other rows"
  case $one$two in
  00) ;;
  10 | 01) cat log1 log2 | grep -q E006 || cat log1 log2 ;;
  *) echo "status $one, $two"; cat log1 log2 ;;
  esac
done
ls twice.csv

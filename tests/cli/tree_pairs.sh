# pairs of trees that were weighed: listed, and chosen again by number and by their lines as a tree file
m=$SYSTEMS/slider_crank/model.yaml
"$COTREE" graph "$m" --trees >pairs
cat pairs

# each number gives the unknowns, rows and operations that are listed, and so do its lines
awk '/^ *[0-9]+[* ]  /{print $1 + 0, $2, $3, $4}' pairs | while read -r n nu nrow cost; do
    "$COTREE" check "$m" --tree "$n" >by_number
    grep -q "speeds $nu, constraints $nrow," by_number && grep -q "^tree .* cost $cost " by_number ||
        echo "number $n is another pair"
    awk -v n="$n" '/^ *[0-9]+[* ]  /{on = $1 + 0 == n} on && /: \[/' pairs >"$n.yaml"
    "$COTREE" check "$m" --tree "$n.yaml" | sed '/^tree /d' >by_file
    sed '/^tree /d' by_number | diff - by_file || echo "the lines of number $n are another pair"
done

"$COTREE" graph "$m" --trees --format json | head -20
"$COTREE" graph "$m" --trees --tree 9 | sed -n 3p
"$COTREE" graph "$SYSTEMS/pendulum/model.yaml" --trees

# what cannot be chosen
"$COTREE" graph "$m" --trees --format svg || echo "status $?"
"$COTREE" check "$m" --tree 11 2>&1 || echo "status $?"
"$COTREE" check "$SYSTEMS/pendulum/model.yaml" --tree 2 2>&1 || echo "status $?"

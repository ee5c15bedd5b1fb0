# Exported C compiles without a warning and has the values recorded beside it, in an empty folder. One open
# system, one with rotations, two with redundant loops, one whose functions are split.
. "$(dirname "$0")/lib.sh"
for system in pendulum tumbling_body stewart bricard chain40; do
  "$COTREE" export "$SYSTEMS/$system/model.yaml" --format c -o $system || echo "exit $?"
  for cc in gcc clang; do
    if command -v $cc >/dev/null; then
      (cd $system && $cc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -O1 -o self_test ./*.c -lm && ./self_test)
    else
      (cd $system && cc -std=c99 -O1 -o self_test ./*.c -lm && ./self_test) # a warning of others is no matter
    fi
  done
done
# four and eight inputs side by side
for lanes in 4 8; do
  for system in pendulum stewart; do
    "$COTREE" export "$SYSTEMS/$system/model.yaml" --lanes $lanes -o lanes_$lanes
    (cd lanes_$lanes && cc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -O1 -o self_test $system*.c -lm && ./self_test)
    grep -c '_lanes(const' lanes_$lanes/$system.h
  done
done
# a wrong number in a lane is found
sed '/^static void pendulum_motion_lanes_lane(/,/^}/s/out\[0\] = /out[0] = 1 + /' lanes_4/pendulum.c >wrong.c
cmp -s wrong.c lanes_4/pendulum.c && echo "no number to change"
cp wrong.c lanes_4/pendulum.c
(cd lanes_4 && cc -std=c99 -O1 -o self_test pendulum*.c -lm && ./self_test) | sed -n '1s/:.*//p;$p'
# the driver ends where the run does: 1000 steps of a method of order 4
"$COTREE" simulate "$SYSTEMS/pendulum/model.yaml" --quiet --until 1 --samples 11 --tolerance 1e-12 -o run.csv
pendulum/self_test 1 100 | cut -d, -f2 >driven
sed 1d run.csv | cut -d, -f2 | paste -d, driven - | awk -F, '{
    d = $1 - $2
    if (d > 1e-9 || d < -1e-9) print "driver: " $1 ", run: " $2
  } END { print NR " times" }'
"$COTREE" export "$SYSTEMS/stewart/model.yaml" -o again
for f in again/*; do cmp "$f" "stewart/${f#again/}"; done
echo '-- what is missing'
say export "$SYSTEMS/pendulum/model.yaml"
say export "$SYSTEMS/pendulum/model.yaml" --format matlab -o p
say export "$SYSTEMS/pendulum/model.yaml" -o no/such/folder
say export "$SYSTEMS/pendulum/model.yaml" -o p --lanes 3

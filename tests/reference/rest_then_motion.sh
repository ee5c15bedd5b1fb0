#!/bin/sh
# rest_then_motion.sh: a flexible manipulator rests for a second and then moves, with vibrations of its link that have to be followed, whatever
# method rest was crossed with. With `method: auto` at T = 1e-10 each output of B05_static_linear_N2 is within 10 T of its largest
# value, the stretch of 3e-5 m, too, which `absolute` would allow to err by 3e-8 of it. The reference file has not so many digits:
# compared with are dop853 and dopri5 at 1e-12, which agree to 2e-11.
# COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for run in auto:1e-10 dop853:1e-12 dopri5:1e-12; do
    "$COTREE" simulate "$folder/B05_static_linear_N2.yaml" -o "$work/${run%:*}.csv" --quiet --method "${run%:*}" --tolerance "${run#*:}" 2>"$work/log" ||
        { cat "$work/log"; exit 1; }
done
echo 1e-10 >"$work/agree"
echo 1e-9 >"$work/asked"
"$COMPARE" "$work/dop853.csv" "$work/dopri5.csv" "$work/agree"
"$COMPARE" "$work/auto.csv" "$work/dop853.csv" "$work/asked"

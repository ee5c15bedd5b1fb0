#!/bin/sh
# measured.sh CASE: the spin-up CASE to the end of its line in measured.txt,
#
#   CASE FROM TO STEP  LAG TIME  AMPLITUDE FREQUENCY EXTENSION
#
# its largest lag [m] and when [s]; from FROM to TO [s] amplitude [m] and frequency [rad/s] of what vibration is left and the mean
# extension [m]. STEP is that of the samples. COTREE is the program.
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}"
line=$(grep "^$1 " "$folder/measured.txt") || { echo "measured.sh: no $1 in measured.txt" >&2; exit 2; }
# shellcheck disable=SC2086
set -- $line
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$COTREE" simulate "$folder/$1.yaml" -o "$work/result.csv" --quiet --until "$3" \
    --samples "$(awk -v to="$3" -v step="$4" 'BEGIN { printf "%d", to / step + 1.5 }')"
awk -F, -v line="$line" '
    function size(x) { return x < 0 ? -x : x }
    # top of the parabola through the samples i-1, i, i+1: its value; place: where
    function top(i,    a, b) {
        a = (v[i + 1] - 2 * v[i] + v[i - 1]) / 2
        b = (v[i + 1] - v[i - 1]) / 2
        place = t[i] - b / (2 * a) * (t[i] - t[i - 1])
        return v[i] - b * b / (4 * a)
    }
    function agree(what, found, wanted, allowed) {
        printf "%-10s %.10g (%.10g)%s\n", what, found, wanted, size(found - wanted) > allowed * size(wanted) ? "  FAILED" : ""
        bad += size(found - wanted) > allowed * size(wanted)
    }
    NR == 1 { for (i = 1; i <= NF; i++) of[$i] = i; next }
    { n++; t[n] = $1; v[n] = $(of["v"]); u[n] = $(of["u"]) }
    END {
        split(line, want, " ")
        low = 2
        for (i = 2; i < n; i++) if (v[i] < v[low]) low = i
        lag = top(low)
        agree("lag", lag, want[5], 1e-7)
        agree("at", place, want[6], 1e-5)
        for (i = 2; i < n; i++) {
            if (t[i] < want[2] - 1e-9) continue
            sum += u[i]
            count++
            if (v[i] >= v[i - 1] && v[i] > v[i + 1] && top(i) > high) high = top(i)
            if (v[i] <= v[i - 1] && v[i] < v[i + 1] && top(i) < deep) deep = top(i)
            if (v[i] < 0 && v[i + 1] >= 0) {
                last = t[i] - v[i] * (t[i + 1] - t[i]) / (v[i + 1] - v[i])
                if (!crossings++) first = last
            }
        }
        agree("amplitude", (high - deep) / 2, want[7], 1e-3)
        agree("frequency", 2 * 3.14159265358979 * (crossings - 1) / (last - first), want[8], 1e-3)
        agree("extension", sum / count, want[9], 1e-6)
        exit bad > 0
    }' "$work/result.csv"

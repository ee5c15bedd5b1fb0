#!/bin/sh
# extremes.sh CASE: runs the model CASE.yaml once and checks its lines in extremes.txt,
#
#   CASE UNTIL SAMPLES COLUMNS KIND FROM TO  VALUE TIME
#
# the extreme of an output from FROM to TO [s]: its value, and when [s] unless TIME is -. KIND is min, max, absmax (the value
# of the largest size) or size (the largest length of the vector of COLUMNS). Between samples the parabola through three
# of them counts. Allowed: 2e-6 of the value, 2e-4 s. Where two extremes in a row are nearly alike and the reference has the
# smaller one, FROM and TO enclose that one alone. COTREE is the program.
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}"
lines=$(grep "^$1 " "$folder/extremes.txt") || { echo "extremes.sh: no $1 in extremes.txt" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "$lines" >"$work/lines"
read -r _ until samples _ <"$work/lines"
"$COTREE" simulate "$folder/$1.yaml" -o "$work/result.csv" --quiet --until "$until" --samples "$samples" 2>/dev/null
awk '
    function size(x) { return x < 0 ? -x : x }
    # key: what the extreme maximises of sample i
    function key(i) {
        if (kind == "max") return data[i, 1]
        if (kind == "min") return -data[i, 1]
        if (kind == "absmax") return size(data[i, 1])
        return length_of(i)
    }
    function length_of(i,    k, sum) {
        for (k = 1; k <= columns; k++) sum += data[i, k] ^ 2
        return sqrt(sum)
    }
    function check(    i, k, name, best, value, time, a, b, sign) {
        columns = split($4, name, ",")
        kind = $5
        for (i = 1; i <= n; i++) for (k = 1; k <= columns; k++) data[i, k] = cell[i, of[name[k]]]
        for (i = 1; i <= n; i++) if (t[i] >= $6 - 1e-9 && t[i] <= $7 + 1e-9 && (!best || key(i) > key(best))) best = i
        value = key(best)
        time = t[best]
        if (best > 1 && best < n && t[best - 1] >= $6 - 1e-9 && t[best + 1] <= $7 + 1e-9) {
            a = (key(best + 1) - 2 * value + key(best - 1)) / 2
            b = (key(best + 1) - key(best - 1)) / 2
            if (a < 0) { time -= b / (2 * a) * (t[best] - t[best - 1]); value -= b * b / (4 * a) }
        }
        sign = kind == "min" || (kind == "absmax" && data[best, 1] < 0) ? -1 : 1
        value *= sign
        off = size(value - $8) > 2e-6 * size($8) || ($9 != "-" && size(time - $9) > 2e-4)
        printf "%s %s of %s, %g to %g s: %.10g (%s) at %.6g s (%s)%s\n", $1, kind, $4, $6, $7, value, $8, time, $9, off ? "  FAILED" : ""
        bad += off
        checked++
    }
    FILENAME ~ /result.csv$/ && FNR == 1 { for (i = 1; i <= split($0, head, ","); i++) of[head[i]] = i; next }
    FILENAME ~ /result.csv$/ { fields = split($0, row, ","); n++; t[n] = row[1]; for (i = 1; i <= fields; i++) cell[n, i] = row[i]; next }
    { check() }
    END { exit bad > 0 || !checked }' "$work/result.csv" "$work/lines"

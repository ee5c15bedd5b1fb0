#!/bin/sh
# measured.sh CASE: the spin-up CASE to the end of its line in measured.txt,
#
#   CASE FROM TO STEP  LAG TIME  AMPLITUDE FREQUENCY EXTENSION
#
# its largest lag [m] and when [s]; from FROM to TO [s] half of what lies between the largest and the smallest sample [m], the
# frequency by the passages through zero [rad/s] and the mean extension [m]. Samples are STEP apart, as those of the reference:
# 4000 steps from FROM to TO. COTREE is the program.
#
# What may differ: the program's error, ten times its tolerance of 1e-9 of the largest value, and the reference's, which is
# how far half the step takes the reference of the exact beam (lag, time, amplitude [m], frequency):
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}"
line=$(grep "^$1 " "$folder/measured.txt") || { echo "measured.sh: no $1 in measured.txt" >&2; exit 2; }
case $1 in
B01_*) halved="1.1e-11 5e-10 9.5e-12 1.8e-10" ;;
B02_*) halved="4.5e-9 2.2e-6 5.1e-12 4.2e-6" ;;
B03_*) halved="1.1e-10 5.9e-8 3.5e-12 2.1e-8" ;;
*)
    echo "measured.sh: no accuracy for $1" >&2
    exit 2
    ;;
esac
# shellcheck disable=SC2086
set -- $line
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$COTREE" simulate "$folder/$1.yaml" -o "$work/result.csv" --quiet --until "$3" \
    --samples "$(awk -v to="$3" -v step="$4" 'BEGIN { printf "%d", to / step + 1.5 }')"
awk -F, -v line="$line" -v halved="$halved" '
    function size(x) { return x < 0 ? -x : x }
    # the polynomial through the samples i-2 .. i+2, x samples behind i
    function at(i, x,    m, k, p, sum) {
        for (m = -2; m <= 2; m++) {
            p = v[i + m]
            for (k = -2; k <= 2; k++) if (k != m) p *= (x - k) / (m - k)
            sum += p
        }
        return sum
    }
    # its top: the value; place: where; bend: the second derivative. Parabolas, each half as wide as the one before
    function top(i,    x, h, a, b, n) {
        x = 0
        h = 1
        for (n = 0; n < 8; n++) {
            a = (at(i, x + h) - 2 * at(i, x) + at(i, x - h)) / 2
            b = (at(i, x + h) - at(i, x - h)) / 2
            x -= h * b / (2 * a)
            if (!n) bend = 2 * a / (t[i] - t[i - 1]) ^ 2
            h /= 2
        }
        place = t[i] + x * (t[i] - t[i - 1])
        return at(i, x)
    }
    # allowed: absolute
    function agree(what, found, wanted, allowed) {
        printf "%-10s %.12g (%.12g), difference %.1e of %.1e%s\n", what, found, wanted, size(found - wanted), allowed, \
            (size(found - wanted) > allowed ? "  FAILED" : "")
        bad += !(size(found - wanted) <= allowed)
    }
    NR == 1 { for (i = 1; i <= NF; i++) of[$i] = i; next }
    {
        n++; t[n] = $1; v[n] = $(of["v"]); u[n] = $(of["u"])
        if (size(u[n]) > longest) longest = size(u[n])
    }
    END {
        split(line, want, " ")
        split(halved, reference, " ")
        program = 10 * 1e-9
        low = 3
        for (i = 3; i < n - 1; i++) if (v[i] < v[low]) low = i
        lag = top(low)
        error = program * size(lag)
        for (i = 1; i <= n; i++) {
            if (t[i] < want[2] - 1e-9) continue
            sum += i == n || !count ? u[i] / 2 : u[i]
            count++
            if (v[i] > high) high = v[i]
            if (v[i] < deep) deep = v[i]
            if (i < n && v[i] * v[i + 1] < 0) {
                last = t[i] - v[i] * (t[i + 1] - t[i]) / (v[i + 1] - v[i])
                if (!crossings++) first = last
            }
        }
        pi = 3.14159265358979
        frequency = pi * (crossings - 1) / (last - first)
        amplitude = (high - deep) / 2
        agree("lag", lag, want[5], error + reference[1] * size(lag))
        # an error that vibrates moves the place where v is flat
        agree("at", place, want[6], frequency * error / bend + reference[2] * place)
        agree("amplitude", amplitude, want[7], error + reference[3])
        # an error of v moves the first and the last passage
        agree("frequency", frequency, want[8], 2 * (error + reference[3]) / amplitude / (last - first) + reference[4] * frequency)
        agree("extension", sum / (count - 1), want[9], program * longest)
        exit (bad > 0)
    }' "$work/result.csv"

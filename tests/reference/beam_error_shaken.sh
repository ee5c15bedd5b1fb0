#!/bin/sh
# beam_error_shaken.sh: the error that a linear beam is said to have where its hub is shaken near a bending frequency. The figure in the summary, and that of
# `check` before the run, must be within a factor of 3 the largest difference of the tips of the linear beam and of 8 foreshortened
# ones that are welded end to end, over the largest deflection of those. Where the base is driven by forces, or a shape is
# excited that is not followed, no figure may be given. COTREE is the program.
set -eu
: "${COTREE:?is the program to test}"
folder=$(cd "$(dirname "$0")" && pwd)
. "$folder/said.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
section="area: 6e-4, Iz: 8e-9, density: 2700, E: 7e10, nu: 0.3"

# model FORMULATION FRAMES JOINT END: 4 m, 8 elements in all; frequencies 4.09, 25.6, 71.7 and 140.5 rad/s
model() {
    echo "cotree: 1"
    echo "bodies:"
    echo "  hub: {mass: 1, inertia: 20}"
    for k in $(seq "$2"); do
        echo "  arm$k: {type: beam, length: 4/$2, elements: 8/$2, $section, formulation: $1, points: {tip: length}}"
    done
    echo "joints:"
    echo "  axle: {type: revolute, axis: z, from: ground, to: hub, $3}"
    before=hub
    for k in $(seq "$2"); do
        echo "  weld$k: {type: weld, from: $before, to: arm$k}"
        before=arm$k.tip
    done
    echo "outputs: [{name: y, value: arm$2.tip.position.y in hub}]"
    echo "simulation: {duration: $4, samples: 401, tolerance: 1e-6, method: radau5}"
}

failed=0
# check NAME END JOINT: with a figure, or without one
run() {
    model linear 1 "$3" "$2" >linear.yaml
    "$COTREE" simulate linear.yaml -o linear.csv --summary linear.json --quiet 2>/dev/null
    said=$(after_run linear.json)
}
figure() {
    run "$@"
    model foreshortening 8 "$3" "$2" >welded.yaml
    "$COTREE" simulate welded.yaml -o welded.csv --quiet 2>/dev/null
    model auto 1 "$3" "$2" >auto.yaml
    before=$(before_run auto.yaml)
    paste -d, linear.csv welded.csv | awk -F, -v name="$1" -v said="$said" -v before="$before" '
        function near(a) { return a < 3 * worst && worst < 3 * a }
        NR > 1 {
            e = $2 - $4; if (e < 0) e = -e; if (e > worst) worst = e
            q = $4 < 0 ? -$4 : $4; if (q > peak) peak = q
        }
        END {
            if (!peak || NR != 402) { print name ": no deflections"; exit 1 }
            worst /= peak
            printf "%s: error %.4g, said %s, before the run %s\n", name, worst, said, before
            exit !(near(said) && near(before))
        }' || failed=1
}
none() {
    run "$@"
    echo "$1: said $said"
    [ "$said" = "not estimated" ] || failed=1
}
figure first 16 'motion: "0.006*sin(3.97*t)"'
figure turning 16 'motion: "if(t < 4, t^2/16, 0.5*t - 1) + 0.004*sin(4.05*t)"'
figure second 8 'motion: "0.0012*sin(25.634*t)"'
figure third 4 'motion: "0.0001*sin(71.7*t)"'
none fourth 4 'motion: "0.00005*sin(140.6*t)"'
figure pushed 10 'effort: "if(t < 4, 20*sin(pi*t/4)^2, 0)"'

# Two rotations, the second about an axis that the first turns: the planes meet. One foreshortened beam is within 0.002 of
# welded ones here.
model=$folder/B05_static_linear_N2.yaml
for formulation in linear foreshortening; do
    sed "s/formulation: linear/formulation: $formulation/; s/interval: 0.05/samples: 601/; s/tolerance: .*/tolerance: 1e-7/" "$model" >steered.yaml
    "$COTREE" simulate steered.yaml -o $formulation.csv --summary $formulation.json --quiet 2>/dev/null
done
paste -d, linear.csv foreshortening.csv | awk -F, -v said="$(after_run linear.json)" '
    NR > 1 {
        e = sqrt(($3 - $7)^2 + ($4 - $8)^2); if (e > worst) worst = e
        q = sqrt($7^2 + $8^2); if (q > peak) peak = q
    }
    END {
        if (!peak || NR != 602) { print "steered: no deflections"; exit 1 }
        worst /= peak
        printf "steered: error %.4g, said %s\n", worst, said
        exit !(said < 1.2 * worst && worst < 1.2 * said)
    }' || failed=1

# before a long run, quick motions fall between the instants that are looked at; slow ones do not
ahead() { # END MOTION WANTED
    model auto 1 "$2" "$1" >auto.yaml
    found=$("$COTREE" check auto.yaml | awk "/linear beam's error/ { found = 1 } END { print found + 0 }")
    echo "$1 s ahead: $found"
    [ "$found" -eq "$3" ] || failed=1
}
ahead 2000 'motion: "0.0012*sin(25.634*t)"' 0
ahead 2000 'motion: "0.01*t + 0.5*sin(0.01*t)"' 1
exit $failed

#!/bin/sh
# lateral_buckling.sh: loads at which two structures buckle sideways, cut into K beams and into twice as many. From the one to the
# other the errors against the exact beam fall by more than 2^(order - 0.5), and both extrapolated are nearer still. COTREE is
# the program.
#
# The cantilever (R10b) is compared with the exact beam without shear, 2974.25512 N, from an own program: shooting through
# the geometrically exact equations, which gives the reference with shear, too, 2973.46370 N; only the
# difference of the two shear stiffnesses, which twists the section, lowers the load: with the smaller one both ways it is
# 2974.29287 N.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

frame() {
    "$folder/../../systems/right_angle_frame/generate.sh" "$1" 1 "$2"
}

# R10b: 1 m, pushed across at the tip in the plane in which it is a hundred times as stiff
cantilever() {
    awk -v K="$1" -v keys="$2" 'BEGIN {
        print "cotree: 1\nparameters: {load: 1}\nbodies:"
        for (i = 1; i <= K; i++)
            printf "  b%d: {type: beam, length: 1/%d, mass_per_length: 1, rotary_inertia: [1e-2, 1e-2, 1e-2], E: 1, G: 1," \
                " area: 7.3e7, Iz: 60830, Iy: 608.3, J: 877.2, formulation: foreshortening, frame: chord, %s," \
                " deformation: [axial, bending-z, bending-y, torsion], points: {end: length}}\n", i, K, keys
        print "joints:\n  j1: {type: weld, from: ground, to: b1}"
        for (i = 2; i <= K; i++)
            printf "  j%d: {type: weld, from: b%d.end, to: b%d}\n", i, i - 1, i
        printf "forces: {push: {type: force, at: b%d.end, value: [0, load, 0]}}\n", K
    }'
}

while read -r structure twist k load order exact; do
    for n in "$k" "$((2 * k))"; do
        case $structure in
        frame) frame "$n" "$twist" ;;
        *) cantilever "$n" "twist: $twist" ;;
        esac >"$work/model.yaml"
        "$COTREE" buckling "$work/model.yaml" --load push --set load="$load" --count 1 -q -o "$work/$n.csv"
    done
    cat "$work/$k.csv" "$work/$((2 * k)).csv" | awk -F, -v exact="$exact" -v load="$load" -v order="$order" \
        -v name="$structure, $twist twist" '
        function size(x) { return x < 0 ? -x : x }
        $1 == 1 { factor[++n] = $2 * size(load) }
        END {
            if (n != 2) { print "no factors"; exit 1 }
            gain = 2 ^ order
            coarse = factor[1] / exact - 1; fine = factor[2] / exact - 1
            best = (gain * factor[2] - factor[1]) / (gain - 1) / exact - 1
            printf "%s, load %g: off by %.2e, %.2e, extrapolated %.2e\n", name, load, coarse, fine, best
            exit !(coarse > gain / sqrt(2) * fine && fine > 0 && best * best < fine * fine)
        }' || failed=1
done <<'END'
frame linear 2 1 2 1.08751793774621
frame linear 2 -1 2 0.680427409356817
frame quadratic 2 1 3 1.08751793774621
frame quadratic 2 -1 3 0.680427409356817
cantilever quadratic 8 1000 2 2974.25512
END

# With shear, by linear elements: the errors have terms of h^2, h^4 and h^6. Taking out one after the other leaves less than a
# quarter each time.
while read -r structure k load exact factors; do
    for n in "$k" "$((2 * k))" "$((4 * k))"; do
        keys="theory: timoshenko, integration: reduced, shear_factor: $factors"
        case $structure in
        frame) frame "$n" linear | sed "s|^    type: beam|&\n    frame: chord\n    $(echo "$keys" | sed 's|, |\\n    |g')|" ;;
        *) cantilever "$n" "$keys" ;;
        esac >"$work/model.yaml"
        "$COTREE" buckling "$work/model.yaml" --load push --set load="$load" --count 1 -q | tail -n 1
    done | awk -F, -v load="$load" -v exact="$exact" -v name="$structure, shear factor $factors" '
        function size(x) { return x < 0 ? -x : x }
        { p[++n] = $2 * size(load) }
        END {
            if (n != 3) { print "no factors"; exit 1 }
            rough = (4 * p[2] - p[1]) / 3; better = (4 * p[3] - p[2]) / 3
            best = (16 * better - rough) / 15
            off = size(best - exact); less = size(better - exact)
            printf "%s, load %g: %.9g, off by %.1e\n", name, load, best, best / exact - 1
            exit !(4 * off < less && 4 * less < size(rough - exact))
        }' || failed=1
done <<'END'
frame 4 1 1.08751793774621 1
frame 2 -1 0.680427409356817 1
cantilever 4 1000 2973.46370102942 [2.34e7/7.3e7,5.025e6/7.3e7]
cantilever 4 1000 2974.29286513 5.025e6/7.3e7
END
exit "$failed"

#!/bin/sh
# accuracy.sh: writes docs/accuracy.md and docs/figures/*.svg from runs of the program. See ./dev accuracy.
# COTREE is the program. Takes about ten minutes.
set -eu
docs=$(cd "$(dirname "$0")" && pwd)
root=$docs/..
reference=$root/tests/reference
: "${COTREE:?is the program}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$docs/figures"

# ---- one run -------------------------------------------------------------------------------------

# run MODEL OPTION...: result.csv and summary.json in $work; how it failed in error.txt
run() {
    model=$1
    shift
    rm -f "$work/result.csv" "$work/summary.json"
    "$COTREE" simulate "$model" -o "$work/result.csv" --quiet --verify --summary "$work/summary.json" "$@" 2>"$work/error.txt"
}

# value KEY: a number or word of summary.json
value() {
    sed -n "s/^ *\"$1\": \"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}\$/\1/p" "$work/summary.json" | head -n 1
}

# error_against REFERENCE.csv: the largest error over its columns and times, each column against its largest value in
# the run; energies and momenta whose exact value is zero are left out.
error_against() {
    awk -F, '
        function size(x) { return x < 0 ? -x : x }
        FNR == 1 { nfile++ }
        nfile == 1 && FNR == 1 { for (i = 1; i <= NF; i++) column[i] = $i; n = NF; next }
        nfile == 1 { rows++; for (i = 1; i <= n; i++) want[rows, column[i]] = $i + 0; next }
        FNR == 1 { for (i = 1; i <= NF; i++) of[$i] = i; next }
        {
            for (i = 2; i <= n; i++) {
                v = size($(of[column[i]]))
                if (v > largest[i]) largest[i] = v
            }
            for (r = 1; r <= rows; r++)
                if (size($1 - want[r, "t"]) < 1e-9)
                    for (i = 2; i <= n; i++) {
                        d = size($(of[column[i]]) - want[r, column[i]])
                        if (d > worst[i]) worst[i] = d
                        if (size(want[r, column[i]]) > exact[i]) exact[i] = size(want[r, column[i]])
                    }
        }
        END {
            for (i = 2; i <= n; i++)
                if (exact[i] > 1e-12 && worst[i] / largest[i] > error) error = worst[i] / largest[i]
            printf "%.1e\n", error
        }' "$1" "$work/result.csv"
}

# ---- what is asked for, what is achieved -------------------------------------------------------------

title() {
    case $1 in
    R01) echo "Andrews' mechanism, 0.03 s" ;;
    R02) echo "Andrews' mechanism (A03), 0.05 s" ;;
    R04) echo "pendulum (A01), 10 s" ;;
    R05_N1) echo "one four-bar (A02), 10 s" ;;
    R05_N2) echo "two four-bars, 10 s" ;;
    R05_N5) echo "five four-bars, 10 s" ;;
    R05_N10) echo "ten four-bars, 10 s" ;;
    R05_N40) echo "forty four-bars, 20 s" ;;
    R06_brick) echo "Bricard mechanism (A04), 10 s" ;;
    R06_slender) echo "the same, thin rods" ;;
    R07_H) echo "spatial slider-crank, 5 s" ;;
    R07_E) echo "the same, crank not balanced" ;;
    R08a) echo "heavy top, 10 s" ;;
    R08b) echo "top through the vertical, 10 s" ;;
    R12) echo "chain of 40 links, 5 s" ;;
    R13_d1) echo "parallelogram through singular positions, 20 s" ;;
    R13_d0999) echo "nearly a parallelogram, 4 s" ;;
    R13_d099_10s) echo "near a parallelogram, 10 s" ;;
    R14_k1e4) echo "spring pendulum, 1e4 N/m, 10 s" ;;
    R14_k1e6) echo "spring pendulum, 1e6 N/m, 10 s" ;;
    R15_M1e-3) echo "light cart, 1 g, 10 s" ;;
    R15_M1e-6) echo "light cart, 1 mg, 10 s" ;;
    R16) echo "six-axis arm, 2 s" ;;
    R04_2000s) echo "pendulum, 2000 s" ;;
    R05_N2_20s) echo "two four-bars, 20 s" ;;
    R16_5s) echo "six-axis arm, 5 s" ;;
    R17a) echo "double pendulum, 10 s" ;;
    R17a_20s) echo "double pendulum, 20 s" ;;
    R17b) echo "double pendulum, middle mass 1 mg, 2 s" ;;
    H_bricard_100s) echo "Bricard mechanism, 100 s" ;;
    H_tumbling_100s) echo "turning over about the middle axis, 100 s" ;;
    H_governor) echo "stiff flyball governor (A05), 10 s" ;;
    H_heavy_first) echo "double pendulum, second mass 1e-8, 10 s" ;;
    H_light_first) echo "double pendulum, first mass 1e-8, 0.5 s" ;;
    H_stiff_limit) echo "spring pendulum, 1e12 N/m, 5 s" ;;
    H_double_1000s) echo "double pendulum, 1000 s" ;;
    *) echo "$1" ;;
    esac
}

asked() {
    echo "| case | 1e-4 | 1e-6 | 1e-8 | 1e-10 | method |"
    echo "| --- | --- | --- | --- | --- | --- |"
    for case in $(cut -d' ' -f1 "$reference/asked.txt") R17a_20s R17b R05_N2_20s R16_5s; do
        line="| $(title "$case") ($case)"
        methods=
        for T in 1e-4 1e-6 1e-8 1e-10; do
            if run "$reference/$case.yaml" --method auto --tolerance $T; then
                line="$line | $(error_against "$reference/$case.reference.csv")"
                method=$(value method)
                case " $methods " in *" $method "*) ;; *) methods="$methods${methods:+ }$method" ;; esac
            else
                line="$line | fails"
            fi
        done
        echo "$line | $(echo "$methods" | sed 's/ /, /g') |"
    done
}

# ---- hard cases -----------------------------------------------------------------------------------------

# hard_row TITLE REFERENCE MODEL OPTION...: REFERENCE may be empty
hard_row() {
    what=$1 against=$2
    shift 2
    run "$@" || { echo "| $what | fails: $(head -n 1 "$work/error.txt") | | | | | | | |"; return; }
    error=
    [ -z "$against" ] || error=$(error_against "$against")
    awk -v what="$what" -v error="$error" -v global="$(value global)" -v drift="$(value energy_drift)" \
        -v position="$(value position_constraint)" -v T="$(value tolerance)" -v method="$(value method)" \
        -v steps="$(value steps)" -v evaluations="$(value evaluations)" -v seconds="$(value integrate)" '
        BEGIN {
            printf "| %s | %g | %s | %.1e | %.1e | %s | %s | %d | %d | %.2g |\n", what, T, error, global, drift,
                (position > 0 ? sprintf("%.0e", position) : ""), method, steps, evaluations, seconds
        }'
}

hard() {
    echo "| case | T | error | estimated | energy drift | constraints | method | steps | evaluations | seconds |"
    echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for case in R13_d1 R13_d0999 R05_N10 R05_N40 R08b R12 R14_k1e4 R14_k1e6 R15_M1e-3 R15_M1e-6 R17a_20s R17b; do
        hard_row "$(title $case)" "$reference/$case.reference.csv" "$reference/$case.yaml" --tolerance 1e-6
    done
    while read -r case system options; do
        against=$reference/$case.reference.csv
        [ "$case" != H_double_1000s ] || against=
        # shellcheck disable=SC2086
        hard_row "$(title "$case")" "$against" "$root/systems/$system/model.yaml" $options
    done <"$reference/hard.txt"
    hard_row "driven pendulum, chaotic, 300 s" "" "$root/systems/hard/driven_pendulum/model.yaml" --tolerance 1e-8
    hard_row "driven pendulum, not chaotic, 300 s" "" "$root/systems/hard/driven_pendulum/model.yaml" --tolerance 1e-8 --set A=0.9
}

# When the chaotic pendulum is lost, by the estimate of the program.
lost() {
    echo "| T | error below 10 T up to |"
    echo "| --- | --- |"
    for T in 1e-4 1e-6 1e-8 1e-10; do
        run "$root/systems/hard/driven_pendulum/model.yaml" --tolerance $T
        printf '| %s | %g s |\n' $T "$(value holds_until)"
    done
}

# ---- work and precision ------------------------------------------------------------------------------------

# cheapest TABLE ERROR: the cheapest setting that meets it, or "none"
cheapest() {
    awk -F, -v wanted="$2" '
        NR > 1 && $5 != "" && $5 <= wanted && (best == "" || $6 < best) { best = $6; what = $1 ", " $2; steps = $7; f = $8 }
        END {
            if (best == "") print "none"
            else printf "%.3g ms (%s: %d steps, %d evaluations)\n", 1e3 * best, what, steps, f
        }' "$1"
}

# figure NAME CASE REFERENCE MODEL OPTION...: table and plot, a line of the table of cheapest settings
figure() {
    name=$1 what=$2 against=$3
    shift 3
    "$COTREE" accuracy "$@" --reference "$against" --error 1e-6 --plot "$docs/figures/$name.svg" -o "$work/$name.csv" --quiet
    echo "| [$what](figures/$name.svg) | $(cheapest "$work/$name.csv" 1e-6) | $(cheapest "$work/$name.csv" 1e-8) |"
}

figures() {
    echo "| problem | error 1e-6 | error 1e-8 |"
    echo "| --- | --- | --- |"
    for case in R05_N1 R05_N2 R05_N10 R01 R06_brick R04 R08b R14_k1e6 R12; do
        figure "accuracy_$case" "$(title $case)" "$reference/$case.reference.csv" "$reference/$case.yaml"
    done
    figure accuracy_governor "$(title H_governor)" "$reference/H_governor.reference.csv" \
        "$root/systems/hard/flyball_governor/model.yaml"
}

# ---- beams -----------------------------------------------------------------------------------------------------

# Errors of the mesh: against the same beam with a converged basis.
elements() {
    echo "| elements | all terms: error | seconds | linear: error | seconds |"
    echo "| --- | --- | --- | --- | --- |"
    for n in 1 2 3 4 5 6 8 10 15 20; do
        line="| $n"
        for kind in "" linear_; do
            sed "s/elements: .*/elements: $n/" "$reference/B01_${kind}N1.yaml" >"$work/beam.yaml"
            if run "$work/beam.yaml" --tolerance 1e-8 --until 8 --samples 5; then
                line="$line | $(error_against "$reference/B01_${kind}fine.reference.csv") | $(value integrate | awk '{ printf "%.2g", $1 }')"
            else
                line="$line | fails |"
            fi
        done
        echo "$line |"
    done
}

# Errors of the frame: against the exact beam.
frames() {
    echo "| frames | elements of each | clamped: largest lag [m] | error | seconds | on the chord: lag [m] | error |"
    echo "| --- | --- | --- | --- | --- | --- | --- |"
    while read -r k n; do
        printf '| %d | %d ' "$k" "$n"
        for frame in clamped chord; do
            "$root/systems/spin_up_welded/generate.sh" "$k" "$n" |
                sed "s/formulation: foreshortening/frame: $frame\n    &/" >"$work/beam.yaml"
            run "$work/beam.yaml" --until 6.76184525385 --samples 2
            awk -F, -v seconds="$(value integrate)" -v frame="$frame" '
                function size(x) { return x < 0 ? -x : x }
                NR == 1 { for (i = 1; i <= NF; i++) if ($i == "across") column = i }
                { v = $column }
                END {
                    printf "| %.9f | %.1e ", v, size(v / -0.573786796554 - 1)
                    if (frame == "clamped") printf "| %.2g ", seconds
                }' "$work/result.csv"
        done
        echo "|"
    done <<'END'
1 10
2 6
4 4
8 3
END
}

# halving CASE SIZE UNTIL COMMAND...: for each N of standard input, of the model that COMMAND N prints, its error against the case and
# that of the values extrapolated from it and the one before; over SIZE, 0: over the largest value of each column
halving() {
    case=$1 common=$2 until=$3
    shift 3
    rm -f "$work/before.csv"
    while read -r n; do
        "$@" "$n" >"$work/beam.yaml"
        run "$work/beam.yaml" --until "$until"
        [ -f "$work/before.csv" ] || cp "$work/result.csv" "$work/before.csv"
        awk -F, -v n="$n" -v common="$common" '
            function size(x) { return x < 0 ? -x : x }
            FNR == 1 { file++; for (i = 1; i <= NF; i++) { if (file == 1) name[i] = $i; of[file, $i] = i }; if (file == 1) n1 = NF; next }
            file == 1 { rows++; for (i = 1; i <= n1; i++) { want[rows, i] = $i; if (size($i) > most[i]) most[i] = size($i) }; next }
            {
                for (r = 1; r <= rows; r++)
                    if (size($1 - want[r, 1]) < 1e-9) {
                        at[file, r] = 1
                        for (i = 2; i <= n1; i++) got[file, r, i] = $(of[file, name[i]])
                    }
            }
            END {
                for (r = 1; r <= rows; r++)
                    for (i = 2; i <= n1 && at[3, r]; i++) {
                        scale = common ? common : most[i]
                        e = size(got[3, r, i] - want[r, i]) / scale
                        x = size((4 * got[3, r, i] - got[2, r, i]) / 3 - want[r, i]) / scale
                        if (e > error) error = e
                        if (x > best) best = x
                    }
                printf "| %d | %.1e | %s |\n", n, error, best == error ? "" : sprintf("%.1e", best)
            }' "$reference/$case.reference.csv" "$work/before.csv" "$work/result.csv"
        cp "$work/result.csv" "$work/before.csv"
    done
}

cantilever() {
    "$root/systems/right_angle_cantilever/generate.sh" "$2" 1 "$1"
}

spatial() {
    echo "| frames in each leg | linear twist | quadratic twist |"
    echo "| --- | --- | --- |"
    for twist in linear quadratic; do
        printf '1\n2\n4\n8\n16\n' | halving R11_K8 10 10 cantilever "$twist" | cut -d '|' -f 1-3 >"$work/$twist.errors"
    done
    cut -d '|' -f 3 "$work/quadratic.errors" | paste -d '|' "$work/linear.errors" - | sed 's/$/|/'
}

with_shear() {
    sed -e "s/elements: .*/elements: $1/" \
        -e 's|^    type: beam|    type: beam\n    theory: timoshenko\n    integration: reduced\n    G: E/3\n    shear_factor: 1|' \
        "$reference/R09_K4.yaml"
}

shear() {
    echo "| elements of each frame | error | extrapolated |"
    echo "| --- | --- | --- |"
    printf '1\n2\n4\n8\n' | halving R09_K4 0 7.5 with_shear
}

# ---- the page ------------------------------------------------------------------------------------------------

processor=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -n 1)
asked >"$work/asked.md"
hard >"$work/hard.md"
lost >"$work/lost.md"
figures >"$work/figures.md"
elements >"$work/elements.md"
frames >"$work/frames.md"
spatial >"$work/spatial.md"
shear >"$work/shear.md"
awk -v folder="$work" -v processor="${processor:-an unknown processor}" '
    /^@[a-z]*@$/ {
        file = folder "/" substr($0, 2, length($0) - 2) ".md"
        while ((getline line <file) > 0) print line
        next
    }
    { gsub(/@processor@/, processor); print }' "$docs/accuracy.in.md" >"$work/accuracy.md"
mv "$work/accuracy.md" "$docs/accuracy.md"

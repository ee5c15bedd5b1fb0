# shellcheck shell=sh
# said.sh: what is said of the error of a linear beam. Source it.

after_run() { # SUMMARY.json
    awk -F': ' '/"validity"/ { inside = 1 } inside && /"error"/ { gsub(/[",]/, "", $2); print $2; exit }' "$1"
}
before_run() { # MODEL.yaml, with `auto`
    "$COTREE" check "$1" | sed -n "/linear beam's error/ { s/.*linear beam's error: \([^;)]*\).*/\1/p; q; }"
}

# estimated NAME KIND: the largest difference of the tips (y, z; 401 samples) of a linear and a foreshortened beam over the largest
# deflection of the latter must be what is said before and after the run within a factor of 3, or more than 1/3 where KIND is
# `beyond 1` and so is that. `model FORMULATION` prints the model.
foretold() {
    for formulation in linear foreshortening auto; do
        model $formulation >$formulation.yaml
        [ $formulation = auto ] ||
            "$COTREE" simulate $formulation.yaml -o $formulation.csv --summary $formulation.json --quiet 2>/dev/null
    done
    said=$(after_run linear.json)
    before=$(before_run auto.yaml)
    paste -d, linear.csv foreshortening.csv |
        awk -F, -v name="$1" -v said="$said" -v before="$before" -v kind="$2" '
            function near(a, b) { return a < 3 * b && b < 3 * a }
            function fits(word) { return kind == "beyond" ? word == "beyond 1" && worst > 1 / 3 : near(word, worst) }
            NR > 1 {
                e = sqrt(($2 - $5)^2 + ($3 - $6)^2); if (e > worst) worst = e
                q = sqrt($5^2 + $6^2); if (q > peak) peak = q
            }
            END {
                if (!peak || NR != 402) { print name ": no deflections"; exit 1 }
                worst /= peak
                printf "%s: error %.4g, said %s, before the run %s\n", name, worst, said, before
                exit !(fits(said) && fits(before))
            }'
}

# A ball that is thrown up to a springy ceiling and would come d above it: it is there for 0.8 ms to 2.7 ms of 2 s, and steps of free
# fall are long. Against the arcs and vibrations between contacts in closed form (30 digits).
cat >ceiling.yaml <<'END'
cotree: 1
parameters: {g: 9.81, k: 1e6, d: 1e-4, u0: 5, top: u0^2/2/g - d}
bodies:
  ball: {mass: 1}
joints:
  z: {type: prismatic, from: ground, to: ball, effort: "-g + if(z.q > top, -k*(z.q - top), 0)", initial: {q: 0, u: u0}}
outputs: [z.q, z.u]
simulation: {duration: 2, samples: 2}
END
while read -r d q u; do
    for method in auto dopri5 rk4 radau5 newmark; do
        for T in 1e-4 1e-6 1e-8 1e-10; do
            [ $method$T = newmark1e-8 ] && break
            "$COTREE" simulate ceiling.yaml --set d=$d --method $method --tolerance $T --quiet -o out.csv
            tail -n 1 out.csv | awk -F, -v T=$T -v q="$q" -v u="$u" -v which="$d $method $T" \
                '($2 - q)^2 > (10*T*q)^2 || ($3 - u)^2 > (10*T*u)^2 { print which ": off by", $2 - q, $3 - u }'
        done
    done
done <<'END'
1e-4 -9.7126646246146482 -14.682046176706415
1e-5 -9.6336889786620414 -14.629182402354182
1e-6 -9.6208012894611432 -14.620537654246085
END
echo '-- side by side'
for lanes in 1 4; do
    "$COTREE" sweep ceiling.yaml --vary d=1e-6:1e-4:8 --method dopri5 --tolerance 1e-10 --lanes $lanes --quiet -o $lanes.csv
done
paste -d, 1.csv 4.csv | awk -F, 'NR > 1 { d = ($3 - $8)^2; if (d > E) E = d } END { print NR - 1, (sqrt(E) < 1e-8 ? "alike" : "not alike: " sqrt(E)) }'

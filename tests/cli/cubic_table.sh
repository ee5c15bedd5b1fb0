# A mass pushed by the numbers of a cubic table, against the same with each piece as its polynomial, integrated by hand:
# `auto` is within ten tolerances, and `dop853` that is asked for, which steps onto the points of the table.
awk 'BEGIN { print "t,f"; for (i = 0; i <= 100; i++) printf "%.17g,%.6f\n", i/10, sin(0.3*i) + 0.5*cos(0.73*i) + (int(i/13) % 2 ? 1 : -1) }' >force.csv
cat >mass.yaml <<'END'
cotree: 1
bodies: {b: {mass: 20}}
joints:
  x: {type: prismatic, from: ground, to: b, effort: {table: force.csv, column: f, interpolate: cubic}}
outputs: [x.q, x.u]
simulation: {duration: 10, samples: 11}
END
for run in "auto 1e-6" "auto 1e-8" "auto 1e-10" "dop853 1e-6" "dop853 1e-8" "dop853 1e-10"; do
    method=${run% *} T=${run#* }
    "$COTREE" simulate mass.yaml --method $method --tolerance $T --quiet -o mass.csv --summary s.json
    # natural spline with second derivatives m by elimination; over a piece, u and q are integrals of cubics
    awk -F, -v T=$T 'FNR == NR { if (FNR > 1) f[FNR - 2] = $2; next }
        FNR == 1 { n = 100; h = 0.1
            for (i = 1; i < n; i++) { d[i] = 4 - (i > 1 ? 1/d[i-1] : 0)
                r[i] = 6*(f[i+1] - 2*f[i] + f[i-1])/(h*h) - (i > 1 ? r[i-1]/d[i-1] : 0) }
            m[n] = 0; for (i = n - 1; i > 0; i--) m[i] = (r[i] - m[i+1])/d[i]; m[0] = 0
            for (i = 0; i < n; i++) {
                q[i+1] = q[i] + u[i]*h + h*h*(f[i]/3 + f[i+1]/6 - h*h*(8*m[i] + 7*m[i+1])/360)/20
                u[i+1] = u[i] + h*((f[i] + f[i+1])/2 - h*h*(m[i] + m[i+1])/24)/20 }
            for (i = 0; i <= n; i += 10) { if (q[i]^2 > Q) Q = q[i]^2; if (u[i]^2 > U) U = u[i]^2 } next }
        { k = 10*(FNR - 2); a = ($2 - q[k])^2/Q; b = ($3 - u[k])^2/U; if (a > E) E = a; if (b > E) E = b }
        END { print T, (sqrt(E) < 10*T ? "within ten tolerances" : "off by " sqrt(E)) }' force.csv mass.csv
    sed -n 's/.*"method": //p' s.json
done
# A cart that a table holds for twenty seconds and then moves to and fro within half a second, against short fixed steps.
awk 'BEGIN { print "t,x"; for (i = 0; i <= 2500; i++) printf "%.2f,%.12f\n", i/100, 0.01*exp(-((i/100 - 20.37)/0.1)^2) }' >move.csv
cat >cart.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  cart: {mass: 1, inertia: 1}
  bar: {mass: 0.7, inertia: 0.02, com: [0, -0.2, 0]}
joints:
  j1: {type: prismatic, from: ground, to: cart, motion: {table: move.csv, column: x, interpolate: cubic}}
  j2: {type: revolute, from: cart, to: bar}
outputs: [j2.q]
simulation: {duration: 24, samples: 25}
END
"$COTREE" simulate cart.yaml --method dop853 --step 0.002 --quiet -o fixed.csv
for T in 1e-4 1e-8; do
    "$COTREE" simulate cart.yaml --tolerance $T --quiet -o cart.csv
    paste -d, fixed.csv cart.csv | awk -F, -v T=$T 'NR > 1 { d = ($2 - $4)^2; if (d > E) E = d; if ($2^2 > Q) Q = $2^2 }
        END { print "moved, " T, (sqrt(E/Q) < 10*T ? "within ten tolerances" : "off by " sqrt(E/Q)) }'
done
# A slow drive sampled at 1 kHz: the rate of a linear table jumps by less than 1e-11 rad/s at each row, and what hangs on
# it follows the sum of these jumps, which is the acceleration of the cubic table.
awk 'BEGIN { print "t,q"; for (i = 0; i <= 5001; i++) printf "%.17g,%.17g\n", i/1000, 1e-6*sin(i/10000) }' >slow.csv
for kind in linear cubic; do
  cat >$kind.yaml <<END
cotree: 1
bodies:
  hub: {mass: 1, inertia: 1, points: {tip: [1, 0, 0]}}
  arm: {mass: 1, inertia: 0.1, com: [0.5, 0, 0]}
joints:
  j: {type: revolute, from: ground, to: hub, motion: {table: slow.csv, column: q, interpolate: $kind}}
  k: {type: revolute, from: hub.tip, to: arm}
outputs: [k.u]
simulation: {duration: 5, samples: 2}
END
  "$COTREE" simulate $kind.yaml --quiet -o $kind.csv
done
awk -F, 'FNR == 3 { u[++n] = $2 } END { e = u[1]/u[2] - 1; print (e^2 < 1e-3^2 ? "the linear table as the cubic one" : "off by " e) }' linear.csv cubic.csv

# shellcheck shell=sh
# element_beam.sh: the beam of element.sh and element_forces.sh, its state of motion and the motion of its base there, from a derivation
# that element.sh names. Deflections are polynomials through values and slopes of both nodes. Source it.

beam() { # FORMULATION, as an entry of `bodies`
    cat <<END
  beam:
    type: beam
    length: 1.6
    elements: 2
    E: 72e9
    G: 27e9
    area: 7.853e-5
    Iy: 4.909e-10
    Iz: 4.909e-10
    density: 2700
    formulation: $1
    deformation: [axial, bending-y, bending-z]
    points: {mid: length/2, tip: length}
END
}
start() { # [U V W of the rates], as a key of the beam
    cat <<END
    initial:
      u: 0.0009375*x + 0.000390625*x^2
      v: 0.10625*x^2 - 0.05078125*x^3 + 0.0244140625*x^4 - 0.006103515625*x^5
      w: -0.07421875*x^2 + 0.0126953125*x^3 + 0.003662109375*x^4 - 0.00152587890625*x^5
      rates:
        u: "${1:-0.003125*x + 0.00078125*x^2}"
        v: "${2:-0.1484375*x^2 + 1.083984375*x^3 - 1.11083984375*x^4 + 0.3204345703125*x^5}"
        w: "${3:--0.5625*x^2 + 0.78125*x^3 - 0.78125*x^4 + 0.244140625*x^5}"
END
}
speeds() { # of the base
    echo "0.6052300197988205, -0.5156611069017545, 0.6146464398035482, 0.7, -1.1, 2.3"
}

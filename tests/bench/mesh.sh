#!/bin/sh
# Models that are closed many times, on standard output:
#
#   mesh.sh rods X Y Z   particles in a block, each joined to its neighbours by massless rods, hung at a corner; a net if Y is 1
#   mesh.sh bars N       bars pinned at the N x N nodes of a plane lattice, every mesh of it a four-bar
set -eu
awk -v kind="$1" -v nx="$2" -v ny="${3:-$2}" -v nz="${4:-$2}" '
  function header(name) { print "cotree: 1\nname: " name "\ngravity: [0, " (name == "rods" ? "0, -9.81]" : "-9.81, 0]") "\nbodies:" }

  # ---- rods
  function name(i, j, k) { return i "_" j "_" k }
  function rod(axis, i, j, k, a, b, c) {
    if (i + a < nx && j + b < ny && k + c < nz)
      printf "  %s%s: {type: distance, from: p%s, to: p%s}\n", axis, name(i, j, k), name(i, j, k), name(i + a, j + b, k + c)
  }
  function place(i, j, k) { # a block that is nowhere straight
    return sprintf("%g, %g, %g", 0.1 * i + 0.01 * ((7 * i + 3 * j + 5 * k) % 5 - 2),
      0.1 * j + 0.01 * ((3 * i + 5 * j + 2 * k) % 7 - 3), -0.1 * k + 0.01 * ((2 * i + 3 * j + 4 * k) % 5 - 2))
  }
  function rods(i, j, k) {
    header("rods")
    print "  ground: {points: {a: [0, 0, 0.1]}}"
    for (k = 0; k < nz; k++) for (j = 0; j < ny; j++) for (i = 0; i < nx; i++)
      printf "  p%s: {type: particle, mass: 0.01}\n", name(i, j, k)
    print "joints:"
    for (k = 0; k < nz; k++) for (j = 0; j < ny; j++) for (i = 0; i < nx; i++)
      printf "  f%s: {type: free, from: ground, to: p%s, initial: {q: [%s]}}\n", name(i, j, k), name(i, j, k), place(i, j, k)
    for (k = 0; k < nz; k++) for (j = 0; j < ny; j++) for (i = 0; i < nx; i++) {
      rod("x", i, j, k, 1, 0, 0); rod("y", i, j, k, 0, 1, 0); rod("z", i, j, k, 0, 0, 1)
    }
    print "  hang: {type: distance, from: ground.a, to: p0_0_0}"
    printf "outputs: [f%s.q1, f%s.q3]\n", name(nx - 1, 0, 0), name(0, ny - 1, nz - 1)
  }

  # ---- bars
  function x(i, j) { return 0.1 * (i * cos(0.2) - j * sin(0.1)) }
  function y(i, j) { return -0.1 * (j * cos(0.1) + i * sin(0.2)) }
  function bar(axis, i, j, a, b) {
    if (i + a >= nx || j + b >= nx)
      return
    nbar++
    bar_name[nbar] = axis i "_" j
    angle[nbar] = atan2(y(i + a, j + b) - y(i, j), x(i + a, j + b) - x(i, j))
    from[nbar] = i "," j; to[nbar] = (i + a) "," (j + b)
  }
  # The bar that is held at the node pins the others there.
  function pin(node, k, end) {
    for (k = 1; k <= nbar; k++) {
      if (from[k] != node && to[k] != node)
        continue
      end = bar_name[k] (to[k] == node ? ".e" : "")
      if (!(node in holder)) {
        holder[node] = k; held_by[node] = end
        continue
      }
      printf "  n%s_%s: {type: revolute, from: %s, to: %s, initial: {q: %.15g}}\n", node_name[node], bar_name[k], held_by[node],
        end, angle[k] - (holder[node] ? angle[holder[node]] : 0)
    }
  }
  function bars(i, j, k) {
    header("bars")
    for (j = 0; j < nx; j++) for (i = 0; i < nx; i++) {
      bar("h", i, j, 1, 0); bar("v", i, j, 0, 1)
      node_name[i "," j] = i "_" j
    }
    for (k = 1; k <= nbar; k++)
      printf "  %s: {mass: 0.1, inertia: 8.3e-5, com: [0.05, 0, 0], points: {e: [0.1, 0, 0]}}\n", bar_name[k]
    print "joints:"
    holder["0,0"] = 0; held_by["0,0"] = "ground"
    for (j = 0; j < nx; j++) for (i = 0; i < nx; i++)
      pin(i "," j)
    print "outputs: [n0_0_h0_0.q]"
  }

  BEGIN {
    if (kind == "rods") rods(); else bars()
    print "simulation: {duration: 0.05, samples: 6}"
  }'

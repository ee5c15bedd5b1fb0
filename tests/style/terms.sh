#!/bin/sh
# A specialist finds a subject by its usual name: the folder with most files that have the term is the one where it is
# treated. Words that a standard term has replaced stay out of the source.
#   terms.sh SOURCE_ROOT
set -eu

cd "$1/src"
bad=0
while IFS=: read -r term folder; do
  [ -n "$term" ] || continue
  found=$(grep -rilE --include='*.[ch]' -e "$term" . | sed 's|^[.]/||; s|/[^/]*$||' | LC_ALL=C sort | uniq -c |
    LC_ALL=C sort -k1,1nr -k2 | awk 'NR == 1 { print $2 }')
  [ "$found" = "$folder" ] || {
    echo "'$term' leads to ${found:-nothing}, not to $folder"
    bad=1
  }
done <<'END'
event location:integrate
dense output:integrate
constraint projection:solve/constraint
coordinate partitioning:solve/constraint
singular configuration:solve/singular
[^a-z_]rank[^_a-z]:solve/constraint
stiffness detection:integrate
error estimate:integrate/implicit
superelement|floating frame:formulate/beam
articulated bod:formulate/recursive
composite bod:formulate/recursive
minimum-norm:solve/constraint
impulse:solve/run
kinematic analysis:solve/run
consistent initial:solve/initial
static equilibrium:solve/initial
END

# retired:the term
while IFS=: read -r word term; do
  grep -rnE --include='*.[ch]' -e "(^|[^a-z_])($word)([^a-z_]|\$)" . && {
    echo "'$word' is called: $term"
    bad=1
  }
done <<'END'
blunt|is_blunt:round-off limit
amplifiers?:sensitive output
poised:state of the vibration modes
plant(s|ed|ing)?:seed of a directional derivative
worn:degraded conditioning
riders?:attached bodies
abreast:batch, lane
recoil:coupled beam error
foresee|foresees|foreseen|unforeseen:predict
glance:small step of a difference quotient
embed|embed_side|embed_view:coordinate partition
striding:crossing
ct_flexible_felt:ct_flexible_effective_base
march:follow the path
felt|unfelt:negligible, error of outputs
toss|tosses|tossed:pseudo-random number
hopeless:failed, cannot succeed
worth_it:what the limit is of
settles|settled|settling:static equilibrium; converged
least_norm_step|shortest_vector:minimum-norm step
half_turned_joint:antiparallel
look_around:tangent stiffness
may_gape|gapes:open loop
swiftest|furthest:largest speed, largest position
take_bearings:reinitialize
warming_steps:steps before counting
leaves_speeds:violates_velocity_constraints
put_off_by:postponed steps
turn_to|turn_on:normalize, apply the Jacobian
foretold|foretell:estimate, predict
sought:chosen, searched
draw_in|draw_mass|scaled_draw:foreshortening
lost_speed|name_lost:lost inertia
swing_matrix|carrying_matrix:centripetal, acceleration matrix
ct_path_sweep|swept:partial velocity; columns of base motion
hand_inwards:transfer inwards
size_beside:largest off-diagonal
ct_flexible_moving|ct_base_turning:relative momentum, base acceleration
share_missed|start_missed:relative residual
way of assembly:assembly mode
grip:lock
END
exit $bad

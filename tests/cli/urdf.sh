# cotree import: arms from URDF move as models written by hand; what is ignored is named; what is wrong is told with its place.
. "$(dirname "$0")/lib.sh"
folder=$(dirname "$0")/urdf

# accelerations ROBOT MODEL RENAME: of the import and of a model, along a motion from rest under gravity
compare() {
  "$COTREE" import "$folder/$1.urdf" -o "$1.yaml" 2>ignored || cat ignored
  names=$(sed -n 's/^outputs: \[\(.*\)\]/\1/p' "$1.yaml")
  all="$names, $(echo "$names" | sed 's/\.q/.u/g'), $(echo "$names" | sed 's/\.q/.a/g')"
  for model in "$1.yaml" "$2"; do
    awk -v all="$all" '/^outputs:/ { skip = 1; next } skip && /^  -/ { next } { skip = 0; print }
      END { print "outputs: [" all "]" }' "$model" >model.yaml
    "$COTREE" simulate model.yaml --until 0.6 --samples 13 --tolerance 1e-11 -q -o "$(basename "$model" .yaml).$1.csv"
  done
  difference "$1.$1.csv" "$(basename "$2" .yaml).$1.csv" | awk -v name="$1" '{ print name ": " ($1 < 1e-10 ? "the same motion" : $1) }'
  "$COTREE" check "$1.yaml" | sed -n 's/^freedoms/&/p'
}
compare puma560 "$SYSTEMS/puma560/model.yaml"
cp "$folder/arm7.yaml" by_hand.yaml
compare arm7 by_hand.yaml
wc -l <ignored

cat >hand.urdf <<'END'
<?xml version="1.0"?>
<robot name="hand &quot;t&quot;">
  <material name="blue"><color rgba="0 0 0.8 1"/></material>
  <link name="base-link">
    <visual><geometry><mesh filename="package://hand/palm.dae"/></geometry><material name="blue"/></visual>
    <visual><geometry><mesh filename="package://hand/mesh/corner.STL" scale="0.01 0.01 0.01"/></geometry></visual>
    <collision><geometry><box size="1 1 1"/></geometry></collision>
  </link>
  <link name="t">
    <inertial><origin xyz="0.1 0 0.2"/><mass value="2"/><inertia ixx="0.1" iyy="0.2" izz="0.15"/></inertial>
    <visual><origin xyz="0 0 1" rpy="0 0.5 0"/><geometry><cylinder radius="0.1" length="2"/></geometry><material name="blue"/></visual>
    <visual><geometry><box size="1 2 3"/></geometry><material name="own"><color rgba="1 0.5 0 1"/><texture filename="x"/></material></visual>
    <visual><geometry><sphere radius="0.3"/></geometry></visual>
  </link>
  <link name="left"><inertial><mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial></link>
  <link name="right"><inertial><mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial></link>
  <joint name="t" type="continuous">
    <origin xyz="0 0 0.5" rpy="0 1.5707963267948966 0"/><parent link="base-link"/><child link="t"/><axis xyz="0 0 1"/>
    <dynamics damping="0.3" friction="0.1"/><safety_controller k_velocity="1"/>
  </joint>
  <joint name="1st finger" type="prismatic">
    <parent link="t"/><child link="left"/><axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="5" velocity="1"/>
  </joint>
  <joint name="2nd finger" type="prismatic">
    <parent link="t"/><child link="right"/><axis xyz="0 -1 0"/><mimic joint="1st finger" multiplier="1.5" offset="0.01"/>
  </joint>
  <transmission name="x"/>
  <gazebo reference="t"/>
</robot>
END
mkdir mesh
printf 'solid c\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid c\n' >mesh/corner.STL
echo "-- what is ignored"
say import hand.urdf -o hand.yaml
cat hand.yaml
"$COTREE" simulate hand.yaml -q -o - --until 0.2 --samples 2 |
  awk -F, 'NR > 2 { d = $4 - 1.5*$3 - 0.01; print d * d < 1e-20 ? "the second finger follows the first" : $0 }'

echo "-- what is wrong"
# wrong TEXT...: lines of a robot
wrong() {
  printf '%s\n' '<robot name="r">' "$@" '</robot>' >wrong.urdf
  say import wrong.urdf 2>&1 | sed -n '/error/p'
}
link() {
  printf '  <link name="%s"/>' "$1"
}
joint() {
  printf '  <joint name="%s" type="%s"><parent link="%s"/><child link="%s"/>%s</joint>' "$@"
}
wrong '  <link name="a">'
wrong "$(link a)" '  &lt' ''
wrong '  <xacro:include filename="x"/>'
wrong '  <link name="${prefix}a"/>'
wrong ''
wrong "$(link a)" "$(link a)" '  <link/>'
wrong "$(link a)" "$(link b)"
wrong "$(link a)" "$(link b)" "$(joint j hinge a b '')" "$(joint k fixed a c '')" '  <joint name="l" type="fixed"/>'
wrong "$(link a)" "$(link b)" "$(joint j fixed a b '')" "$(joint k fixed b a '')"
wrong "$(link a)" "$(link b)" "$(joint j fixed a b '')" "$(joint k fixed a b '')" "$(joint j fixed a b '')"
wrong "$(link a)" "$(link b)" "$(joint j revolute a b '<axis xyz="0 0 0"/><origin xyz="1 2"/><limit lower="x"/>')"
wrong "$(link a)" "$(link b)" "$(joint j revolute a b '<mimic joint="j"/>')"
wrong "$(link a)" "$(link b)" "$(link c)" "$(joint j revolute a b '<mimic joint="k"/>')" "$(joint k revolute b c '<mimic joint="j"/>')"
wrong "$(link a)" "$(link b)" "$(link c)" "$(joint j fixed a b '')" "$(joint k revolute b c '<mimic joint="j"/>')"
wrong '  <link name="a"><inertial><mass value="-1"/></inertial></link>' \
  '  <link name="b"><inertial><inertia ixx="1"/></inertial><visual/></link>' \
  '  <link name="c"><visual><geometry/></visual><visual><geometry><box size="1 2"/></geometry></visual></link>'
printf '<!DOCTYPE r [<!ENTITY a "aaaa">]>\n<robot name="&a;"/>\n' >wrong.urdf
say import wrong.urdf
: >wrong.urdf
say import wrong.urdf
awk 'BEGIN { for (i = 0; i < 200; i++) print "<a>" }' >wrong.urdf
say import wrong.urdf
say import missing.urdf
say import
say import hand.urdf hand.yaml

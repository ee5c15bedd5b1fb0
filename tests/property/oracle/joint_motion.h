// The motion that a joint type allows, in axes of its `from` frame.
#ifndef CT_TEST_ORACLE_JOINT_MOTION_H
#define CT_TEST_ORACLE_JOINT_MOTION_H

#include "tests/property/oracle/scene.h"

/// Pose of `to` in `from`, and its twist and the twist's rate as functions of the speeds u:
///
///     angular velocity  w = sum_i angular[i] u_i        rate  sum_i angular[i] u_i' + angular_bias
///     velocity          v = sum_i linear[i] u_i         rate  sum_i linear[i] u_i' + linear_bias
///
/// v is the rate of the place of `to` as seen in `from`.
struct joint_motion {
    struct pose pose;
    struct vector angular[6], linear[6], angular_bias, linear_bias;
};

/// Source: docs/format.md, Joints; derivatives by hand.
struct joint_motion joint_motion(const struct joint *j, const double *q, const double *u);

#endif

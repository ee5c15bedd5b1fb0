// See urdf.h.
#include "import/urdf.h"

#include <math.h>

void ct_urdf_rotation(double R[9], const double rpy[3])
{
    const double cr = cos(rpy[0]), sr = sin(rpy[0]), cp = cos(rpy[1]), sp = sin(rpy[1]),
                 cy = cos(rpy[2]), sy = sin(rpy[2]);
    R[0] = cy * cp;
    R[1] = sy * cp;
    R[2] = -sp;
    R[3] = cy * sp * sr - sy * cr;
    R[4] = sy * sp * sr + cy * cr;
    R[5] = cp * sr;
    R[6] = cy * sp * cr + sy * sr;
    R[7] = sy * sp * cr - cy * sr;
    R[8] = cp * cr;
}

void ct_urdf_turn_inertia(double out[6], const double I[6], const double R[9])
{
    static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                for (int l = 0; l < 3; l++)
                    sum += R[i + 3 * k] * I[place[k][l]] * R[j + 3 * l];
            out[place[i][j]] = sum;
        }
}

// See view.h.
#include "draw/view.h"

#include <math.h>
#include <string.h>

// right and up; toward = right x up
static const double directions[3][2][3] = {
    {{0, 1, 0}, {0, 0, 1}}, // x
    {{1, 0, 0}, {0, 0, 1}}, // y
    {{1, 0, 0}, {0, 1, 0}}, // z
};
static const char *const names[] = {"x", "y", "z", "iso"};

static int longest(const double v[3])
{
    int k = 2;
    for (int i = 1; i >= 0; i--)
        if (fabs(v[i]) > fabs(v[k]))
            k = i;
    return k;
}

// The vertical axis of ground: against gravity, if that is along an axis; otherwise z.
static int upward(const struct ct_scene *s)
{
    const int k = longest(s->gravity);
    return s->gravity[k] < 0 ? k : 2;
}

// Isometric view: the viewing direction has equal angles with the three axes; the vertical axis
// is upright.
static void set_iso(struct ct_view *v, int up)
{
    static const double axes[3][2][3] = {{{0, 1, 0}, {0, 0, 1}},  // up is x
                                         {{1, 0, 0}, {0, 0, -1}}, // y
                                         {{1, 0, 0}, {0, 1, 0}}}; // z
    const double *a = axes[up][0], *b = axes[up][1];
    for (int i = 0; i < 3; i++) {
        v->right[i] = (a[i] + b[i]) / sqrt(2);
        v->up[i] = (b[i] - a[i] + 2 * (i == up)) / sqrt(6);
    }
    v->shortening = sqrt(2.0 / 3);
}

static const char *standard(const struct ct_scene *s)
{
    // Layout: of the picture
    const double along = 1 - 1e-9; // cosine; round-off of a normal that is an axis
    const int k = longest(s->normal);
    return s->is_planar && fabs(s->normal[k]) > along ? names[k] : names[3];
}

bool ct_view_choose(struct ct_view *v, const struct ct_scene *s, const char *name)
{
    int k = 0;
    if (!name)
        name = standard(s);
    while (k < 4 && strcmp(names[k], name) != 0)
        k++;
    if (k == 4)
        return false;
    *v = (struct ct_view){.name = names[k], .scale = 1, .shortening = 1};
    if (k == 3) {
        set_iso(v, upward(s));
    } else {
        memcpy(v->right, directions[k][0], sizeof v->right);
        memcpy(v->up, directions[k][1], sizeof v->up);
    }
    for (int i = 0; i < 3; i++)
        v->toward[i] = v->right[(i + 1) % 3] * v->up[(i + 2) % 3]
                     - v->right[(i + 2) % 3] * v->up[(i + 1) % 3];
    return true;
}

struct ct_spot ct_view_spot(const struct ct_view *v, const double position[3])
{
    return (struct ct_spot){v->origin.x + v->scale * (ct_dot3(v->right, position) - v->low[0]),
                            v->origin.y - v->scale * (ct_dot3(v->up, position) - v->low[1])};
}

struct ct_spot ct_view_across(const struct ct_view *v, const double direction[3])
{
    return (struct ct_spot){ct_dot3(v->right, direction), -ct_dot3(v->up, direction)};
}

double ct_view_depth(const struct ct_view *v, const double position[3])
{
    return ct_dot3(v->toward, position);
}

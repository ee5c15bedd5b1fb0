// Read bodies, their points and the frames of both.
#include "component/read.h"

#include <math.h>
#include <string.h>

static void add_frame(struct ct_reader *r, const char *name, struct ct_mark at, int body)
{
    struct ct_model *m = r->m;
    const struct ct_frame f = {
        .name = name, .mark = at, .body = body, .at = {{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}}};
    ct_names_put(r->a, &m->frame_index, name, (int)m->nframe);
    CT_PUSH(r->a, m->frame, m->nframe, m->frame_cap, f);
}

// Declare the names of all points, wrong ones included, so that references to them give no further
// errors.
static void declare_points(struct ct_reader *r, int body, const struct ct_node *node)
{
    const struct ct_node *points = ct_node_get(node, "points");
    for (size_t i = 0; points && points->kind == CT_NODE_MAP && i < points->n; i++) {
        const struct ct_node_pair *p = &points->pair[i];
        if (!ct_read_name(r, p->key, p->mark, "point"))
            continue;
        const char *name
            = ct_arena_printf(r->a, "%s.%s", r->m->body[body].instance.name, p->key);
        if (ct_model_find_frame(r->m, name) < 0) // a duplicate key has been reported
            add_frame(r, name, p->mark, body);
    }
}

static int add_body(struct ct_reader *r, const char *name, struct ct_mark at)
{
    struct ct_model *m = r->m;
    struct ct_body b = {.frame = (int)m->nframe};
    b.instance.name = name;
    b.instance.mark = at;
    b.instance.from = b.instance.to = -1;
    b.mass = CT_EX_ZERO;
    b.com = (ct_ex3){{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
    const int i = (int)m->nbody;
    ct_names_put(r->a, &m->body_index, name, i);
    CT_PUSH(r->a, m->body, m->nbody, m->body_cap, b);
    CT_PUSH(r->ctx->scratch, r->body_node, r->nbody_node, r->body_node_cap, NULL);
    add_frame(r, name, at, i);
    return i;
}

void ct_read_bodies_declare(struct ct_reader *r)
{
    const struct ct_node_pair *ground = NULL;
    const struct ct_node_pair *section = ct_node_find(r->root, "bodies");
    const struct ct_node *node = section ? section->value : NULL;
    if (node && ct_node_is_null(node))
        node = NULL;
    const bool ok = node && ct_read_shape(r, node, CT_NODE_MAP, "a map of bodies");
    if (ok)
        ground = ct_node_find(node, "ground");
    add_body(r, "ground", ground ? ground->mark : (struct ct_mark){r->m->file, 0, 0});
    if (ground) {
        r->body_node[0] = ground->value;
        declare_points(r, 0, ground->value);
    }
    for (size_t i = 0; ok && i < node->n; i++) {
        const struct ct_node_pair *p = &node->pair[i];
        if (p == ground || !ct_read_component_name(r, p, "body"))
            continue;
        const int body = add_body(r, p->key, p->mark);
        r->body_node[body] = p->value;
        declare_points(r, body, p->value);
    }
}

static bool read_ground(struct ct_reader *r, const struct ct_node *node)
{
    if (ct_node_is_null(node))
        return true;
    if (!ct_read_shape(r, node, CT_NODE_MAP, "a map of keys"))
        return false;
    bool ok = true;
    for (size_t i = 0; i < node->n; i++)
        if (strcmp(node->pair[i].key, "points") != 0 && strcmp(node->pair[i].key, "shape") != 0)
            ok = ct_error(r->ctx, node->pair[i].mark, CT_E_GROUND,
                          "the ground has 'points' and a 'shape' only, no '%s'",
                          node->pair[i].key);
    ok &= ct_read_solids(r, &r->m->body[0], node);
    return ct_read_points(r, &r->m->body[0], node) && ok;
}

// ---- mass and inertia --------------------------------------------------------------------------

static bool check_mass(struct ct_reader *r, const struct ct_body *b,
                       const struct ct_value *mass)
{
    double v;
    if (!mass->given || !ct_read_number(r, b->mass, &v) || !(v < 0))
        return true;
    return ct_error(r->ctx, mass->mark, CT_E_MASS, "body '%s': the mass is negative (%g kg)",
                    b->instance.name, v);
}

// Jacobi rotation in the plane of i and j that makes A_ij vanish.  (golub2013, 8.5)
static void jacobi_rotation(double A[3][3], int i, int j)
{
    const int k = 3 - i - j;
    if (A[i][j] == 0)
        return;
    const double tau = (A[j][j] - A[i][i]) / (2 * A[i][j]);
    const double t = (tau < 0 ? -1 : 1) / (fabs(tau) + hypot(1, tau));
    const double c = 1 / hypot(1, t), s = t * c, ki = A[k][i], kj = A[k][j];
    A[i][i] -= t * A[i][j];
    A[j][j] += t * A[i][j];
    A[i][j] = A[j][i] = 0;
    A[k][i] = A[i][k] = c * ki - s * kj;
    A[k][j] = A[j][k] = s * ki + c * kj;
}

static void order(double *a, double *b)
{
    const double low = fmin(*a, *b);
    *b = fmax(*a, *b);
    *a = low;
}

// Principal moments (3, ascending) of I = [xx yy zz xy xz yz] by Jacobi's method; exact for a
// diagonal I.
static void principal_moments(const double I[6], double lam[3])
{
    enum { SWEEPS = 8 }; // Limit: sweeps of Jacobi's method, which converges quadratically
    double A[3][3] = {{I[0], I[3], I[4]}, {I[3], I[1], I[5]}, {I[4], I[5], I[2]}};
    for (int n = 0; n < SWEEPS; n++)
        for (int k = 2; k >= 0; k--)
            jacobi_rotation(A, k == 0, k == 2 ? 1 : 2);
    for (int i = 0; i < 3; i++)
        lam[i] = A[i][i];
    order(&lam[0], &lam[1]);
    order(&lam[1], &lam[2]);
    order(&lam[0], &lam[1]);
}

// Check that the inertia is physical: principal moments are sums of squares, so none is negative,
// and none exceeds the sum of the other two.
static bool check_inertia(struct ct_reader *r, const struct ct_body *b,
                          const struct ct_value *given)
{
    double I[6], largest = 0, lam[3];
    for (int i = 0; i < 6; i++) {
        if (!ct_read_number(r, b->inertia[i], &I[i]))
            return true;
        largest = fmax(largest, fabs(I[i]));
    }
    if (largest == 0)
        return true;
    for (int i = 0; i < 6; i++)
        I[i] /= largest; // scaled, to avoid overflow and underflow of products
    principal_moments(I, lam);
    // Derived: relative error of data printed with six or seven digits, as in data sheets and other
    // programs
    const double roundoff = 1e-6 * lam[2];
    if (lam[0] >= -roundoff && lam[2] <= lam[0] + lam[1] + roundoff)
        return true;
    return ct_error(
        r->ctx, given->mark, CT_E_INERTIA,
        "body '%s': no body has the principal moments of inertia %g, %g, %g kg*m^2: %s",
        b->instance.name, lam[0] * largest, lam[1] * largest, lam[2] * largest,
        lam[0] < -roundoff ? "one is negative" : "one is larger than the sum of the others");
}

static bool fill_inertia(struct ct_reader *r, struct ct_body *b, const struct ct_value *v)
{
    if (!v->given)
        return true;
    if (v->n != 1 && v->n != 3 && v->n != 6)
        return ct_error(r->ctx, v->mark, CT_E_LENGTH,
                        "the list has %zu values; one moment, [Ixx, Iyy, Izz] or "
                        "[Ixx, Iyy, Izz, Ixy, Ixz, Iyz] is wanted",
                        v->n);
    for (size_t i = 0; i < 6; i++)
        b->inertia[i] = i < v->n ? v->e[i] : CT_EX_ZERO;
    if (v->n == 1)
        b->inertia[1] = b->inertia[2] = v->e[0];
    return check_inertia(r, b, v);
}

static bool fill_rigid(struct ct_reader *r, struct ct_body *b)
{
    const struct ct_value *com = ct_instance_value(&b->instance, "com");
    for (int i = 0; com->given && i < 3; i++)
        b->com.e[i] = com->e[i];
    return fill_inertia(r, b, ct_instance_value(&b->instance, "inertia"));
}

// ---- a body ------------------------------------------------------------------------------------

// A key of rigid bodies in a particle gets a message of its own, not "unknown key".
static bool check_particle_keys(struct ct_reader *r, const struct ct_body *b,
                                const struct ct_node *node)
{
    static const char *const names[] = {"points", "inertia", "com"};
    bool ok = true;
    for (size_t i = 0; i < COUNT(names); i++) {
        const struct ct_node_pair *p = ct_node_find(node, names[i]);
        if (p)
            ok = ct_error(r->ctx, p->mark, CT_E_PARTICLE,
                          "'%s' is a particle: it has a mass, but no '%s'", b->instance.name,
                          names[i]);
    }
    return ok;
}

static bool read_body(struct ct_reader *r, struct ct_body *b, const struct ct_node *node)
{
    struct ct_instance *self = &b->instance;
    const struct ct_node_pair p = {self->name, self->mark, node};
    self->cls = ct_read_class(r, CT_FAMILY_BODY, &p, "body");
    if (!self->cls)
        return false;
    ct_read_alloc_values(r, self);
    if (self->cls->body == CT_BODY_BEAM)
        return ct_read_beam(r, b, node);
    b->is_particle = self->cls->body == CT_BODY_PARTICLE;
    if (b->is_particle && !check_particle_keys(r, b, node))
        return false;
    bool ok = ct_read_component_keys(r, self, node, "body", false);
    ok &= ct_read_own_values(r, self, node);
    ok &= ct_read_solids(r, b, node);
    if (!b->is_particle)
        ok &= ct_read_points(r, b, node);
    if (!ok)
        return false;
    const struct ct_value *mass = ct_instance_value(self, "mass");
    if (mass->given)
        b->mass = mass->e[0];
    ok = check_mass(r, b, mass);
    return (b->is_particle || fill_rigid(r, b)) && ok;
}

void ct_read_bodies_fill(struct ct_reader *r)
{
    if (r->body_node[0])
        read_ground(r, r->body_node[0]);
    for (size_t i = 1; i < r->m->nbody; i++)
        read_body(r, &r->m->body[i], r->body_node[i]);
}

// Read joints: frames and own keys first, then the values per coordinate, whose number these
// decide.
#include "component/read.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// What a speed or coordinate measures; it determines the units of the values per coordinate.
enum measure { LENGTH, ANGLE, ROTATION, QUATERNION, UNKNOWN };

static const struct {
    const char *key, *unit[5]; // of LENGTH, ANGLE, ROTATION, QUATERNION, UNKNOWN; NULL: any
} units[] = {
    {"q", {"m", "rad", "rad", "", NULL}},
    {"u", {"m/s", "rad/s", "rad/s", "", NULL}},
    {"stiffness", {"N/m", "N*m/rad", "N*m/rad", "", NULL}},
    {"damping", {"N*s/m", "N*m*s/rad", "N*m*s/rad", "", NULL}},
    {"rest", {"m", "rad", "rad", "", NULL}},
    {"effort", {"N", "N*m", "N*m", "", NULL}},
    {"motion", {"m", "rad", "rad", "", NULL}},
};

static const char *unit_of(const char *key, enum measure m)
{
    for (size_t i = 0; i < COUNT(units); i++)
        if (strcmp(units[i].key, key) == 0)
            return units[i].unit[m];
    return NULL;
}

struct joint {
    struct ct_instance *self;
    struct ct_value *value; // of self
    const struct ct_node *node;
    bool at_particle;
    enum measure speed[CT_MAX_COORD]; // by speed
    int quaternion;                   // index of the first of its four coordinates, or -1
};

static struct ct_value *value_of(const struct joint *j, const char *key)
{
    return &j->value[ct_instance_value(j->self, key) - j->self->value];
}

// A gear couples other joints: it has no frames, no coordinates, and no keys of the family.
static bool has_frames(const struct ct_component_class *cls)
{
    for (int i = 0; i < cls->nkey; i++)
        if (cls->key[i].kind == CT_VALUE_JOINTS)
            return false;
    return true;
}

void ct_read_joints_declare(struct ct_reader *r)
{
    struct ct_model *m = r->m;
    const struct ct_node *node = ct_node_get(r->root, "joints");
    if (!node || ct_node_is_null(node)
        || !ct_read_shape(r, node, CT_NODE_MAP, "a map of joints"))
        return;
    for (size_t i = 0; i < node->n; i++) {
        const struct ct_node_pair *p = &node->pair[i];
        if (!ct_read_component_name(r, p, "joint"))
            continue;
        const struct ct_instance new = {.name = p->key, .mark = p->mark, .from = -1, .to = -1};
        ct_names_put(r->a, &m->joint_index, p->key, (int)m->njoint);
        CT_PUSH(r->a, m->joint, m->njoint, m->joint_cap, new);
        CT_PUSH(r->ctx->scratch, r->joint_node, r->njoint_node, r->joint_node_cap, p->value);
    }
}

// ---- counts ------------------------------------------------------------------------------------

static bool is_particle_frame(const struct ct_reader *r, int frame)
{
    return frame >= 0 && r->m->body[r->m->frame[frame].body].is_particle;
}

// Find what each coordinate measures, from the motion function of the class.
static void find_measures(struct ct_reader *r, struct joint *j)
{
    struct ct_instance *self = j->self;
    j->quaternion = -1;
    for (int i = 0; i < CT_MAX_COORD; i++)
        j->speed[i] = UNKNOWN;
    if (!self->cls->motion || !r->parameters_ok || self->ncoord > CT_MAX_COORD)
        return;
    struct ct_motion m = {
        .ncoord = self->ncoord, .nfree = self->nfree, .quaternion = -1, .value = r->m->value};
    self->cls->motion(r->m->x, self, &m);
    j->quaternion = m.quaternion;
    int n = 0;
    for (int i = 0; i < m.nmeasure; i++)
        switch (m.measure[i].kind) {
        case CT_MEASURE_LENGTH:
            j->speed[n++] = LENGTH;
            break;
        case CT_MEASURE_ANGLE:
            j->speed[n++] = ANGLE;
            break;
        case CT_MEASURE_QUATERNION:
            for (int k = 0; k < 3; k++)
                j->speed[n++] = ROTATION;
            break;
        }
}

// Next to a particle only the translational part of a joint exists; lengths come first.
static void drop_rotations(struct joint *j)
{
    struct ct_instance *self = j->self;
    if (self->local)
        return; // all coordinates of a custom joint may move its position
    int n = 0;
    while (n < self->nfree && j->speed[n] == LENGTH)
        n++;
    self->ncoord = self->nfree = n;
    j->quaternion = -1;
}

static void count_coordinates(struct ct_reader *r, struct joint *j)
{
    struct ct_instance *self = j->self;
    if (self->cls->ncoord >= 0) {
        self->ncoord = self->cls->ncoord;
        self->nfree = self->cls->nfree;
    }
    find_measures(r, j);
    if (j->at_particle)
        drop_rotations(j);
}

static bool check_has_coordinate(struct ct_reader *r, const struct joint *j,
                                 const struct ct_node_pair *p)
{
    const struct ct_instance *self = j->self;
    if (self->nfree > 0)
        return true;
    return ct_error(r->ctx, p->mark, CT_E_COORDINATE,
                    "joint '%s' (%s) has no coordinate%s for '%s'", self->name, self->cls->name,
                    self->cls->nfree != 0 ? " beside a particle" : "", p->key);
}

// ---- lists of coordinates ----------------------------------------------------------------------

static bool hole_allowed(const char *key)
{
    return strcmp(key, "motion") == 0 || strcmp(key, "effort") == 0 || strcmp(key, "q") == 0
        || strcmp(key, "u") == 0;
}

static bool read_entry(struct ct_reader *r, const struct ct_node *node,
                       const struct ct_key *key, enum measure m, struct ct_value *v, size_t i)
{
    v->at[i] = node->mark;
    if (ct_node_is_null(node) && hole_allowed(key->name)) {
        v->hole[i] = true;
        return true;
    }
    return ct_read_expr(r, node, key->flags, unit_of(key->name, m), &v->e[i]);
}

// Read n values; one value needs no list. measure: of each.
static bool read_entries(struct ct_reader *r, const struct ct_node *node,
                         const struct ct_key *key, size_t n, const enum measure *measure,
                         const char *wanted, struct ct_value *v)
{
    v->given = true;
    v->mark = node->mark;
    const bool alone = node->kind != CT_NODE_LIST;
    if (alone && n != 1)
        return ct_error(r->ctx, node->mark, CT_E_LENGTH, "found %s where %s is wanted",
                        ct_node_what(node), wanted);
    if (!alone && !ct_read_list(r, node, n, n, wanted))
        return false;
    v->n = n;
    v->e = CT_NEWN(r->a, ct_ex, n);
    v->at = CT_NEWN(r->a, struct ct_mark, n);
    v->hole = CT_NEWN(r->a, bool, n);
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= read_entry(r, alone ? node : node->item[i], key, measure[i], v, i);
    return ok;
}

// A rotation by a quaternion has no angle on which a spring or a driver could act.
static bool check_rotation_entries(struct ct_reader *r, const struct joint *j,
                                   const struct ct_key *key, const struct ct_value *v)
{
    if (strcmp(key->name, "damping") == 0 || strcmp(key->name, "effort") == 0)
        return true;
    bool ok = true;
    for (size_t i = 0; i < v->n; i++)
        if (j->speed[i] == ROTATION && !v->hole[i] && !ct_ex_is_zero(v->e[i]))
            ok = ct_error(r->ctx, v->at[i], CT_E_COORDINATE,
                          "the rotation of joint '%s' (%s) has no angle for '%s'%s",
                          j->self->name, j->self->cls->name, key->name,
                          strcmp(key->name, "motion") == 0 ? "" : "; use a bushing");
    return ok;
}

static bool read_coords(struct ct_reader *r, struct joint *j, const struct ct_key *key,
                        const struct ct_node_pair *p)
{
    if (!check_has_coordinate(r, j, p))
        return false;
    struct ct_value *v = value_of(j, key->name);
    const size_t n = (size_t)j->self->nfree;
    const char *wanted
        = n == 1 ? "one value"
                 : ct_arena_printf(r->ctx->scratch, "a list of %zu (one per coordinate%s)", n,
                                   j->quaternion >= 0 ? " or rotation axis" : "");
    return read_entries(r, p->value, key, n, j->speed, wanted, v)
        && check_rotation_entries(r, j, key, v);
}

// ---- initial -----------------------------------------------------------------------------------

static bool check_quaternion(struct ct_reader *r, const struct joint *j,
                             const struct ct_value *q)
{
    double sum = 0;
    for (size_t i = (size_t)j->quaternion; i < q->n; i++) {
        double v;
        if (q->hole[i] || !ct_read_number(r, q->e[i], &v))
            return true;
        sum += v * v;
    }
    return sum > 0 || ct_error(r->ctx, q->mark, CT_E_INITIAL, "a quaternion cannot be all 0");
}

static bool read_initial_q(struct ct_reader *r, const struct joint *j,
                           const struct ct_node *node, bool beside_rotate, struct ct_value *q)
{
    static const struct ct_key key = {.name = "q"};
    enum measure measure[CT_MAX_COORD + 1];
    const int n = beside_rotate ? j->quaternion : j->self->ncoord;
    for (int i = 0; i < n; i++)
        measure[i] = j->quaternion >= 0 && i >= j->quaternion ? QUATERNION : j->speed[i];
    const char *wanted
        = n == 1 ? "one value"
                 : ct_arena_printf(r->ctx->scratch, "a list of %d%s", n,
                                   j->quaternion < 0 ? ""
                                   : beside_rotate   ? " beside 'rotate'"
                                                   : " (with a quaternion; or give 'rotate')");
    if (n == 0)
        return ct_error(r->ctx, node->mark, CT_E_CONFLICT,
                        "'rotate' gives all coordinates of joint '%s'; 'q' gives them again",
                        j->self->name);
    if (!read_entries(r, node, &key, (size_t)n, measure, wanted, q))
        return false;
    return j->quaternion < 0 || beside_rotate || check_quaternion(r, j, q);
}

static bool read_initial_rotate(struct ct_reader *r, const struct joint *j,
                                const struct ct_node_pair *p, struct ct_value *v)
{
    if (j->quaternion < 0)
        return ct_error(r->ctx, p->mark, CT_E_COORDINATE,
                        "joint '%s' (%s) has no free rotation to give as 'rotate'; give 'q'",
                        j->self->name, j->self->cls->name);
    v->given = true;
    v->mark = p->value->mark;
    v->n = 1;
    return ct_read_rotations(r, p->value, 0, &v->turn, &v->nturn);
}

static bool read_initial(struct ct_reader *r, struct joint *j, const struct ct_node_pair *p)
{
    static const char *const keys[] = {"q", "u", "rotate", "guess"};
    static const struct ct_key u_key = {.name = "u"};
    struct ct_initial *initial = &j->self->initial;
    const struct ct_node *node = p->value;
    if (!check_has_coordinate(r, j, p)
        || !ct_read_shape(r, node, CT_NODE_MAP, "a map {q: ..., u: ...}"))
        return false;
    struct ct_value *self = value_of(j, "initial");
    self->given = true;
    self->mark = node->mark;
    const char *what
        = ct_arena_printf(r->ctx->scratch, "'initial' of joint '%s'", j->self->name);
    bool ok = ct_read_keys(r, node, what, keys, COUNT(keys));
    const struct ct_node *q = ct_node_get(node, "q"), *u = ct_node_get(node, "u");
    const struct ct_node_pair *rotate = ct_node_find(node, "rotate");
    if (rotate)
        ok &= read_initial_rotate(r, j, rotate, &initial->rotate);
    if (q)
        ok &= read_initial_q(r, j, q, rotate && j->quaternion >= 0, &initial->q);
    if (u) {
        const size_t n = (size_t)j->self->nfree;
        const char *wanted
            = n == 1 ? "one value" : ct_arena_printf(r->ctx->scratch, "a list of %zu", n);
        ok &= read_entries(r, u, &u_key, n, j->speed, wanted, &initial->u);
    }
    if (ct_node_get(node, "guess"))
        ok &= ct_read_boolean(r, ct_node_get(node, "guess"), &initial->guess);
    return ok;
}

// ---- start values that contradict a driver -----------------------------------------------------

// Value of an expression of t at t = 0; false if it has none.
static bool value_at_start(struct ct_reader *r, ct_ex e, double *v)
{
    const ct_ex zero = CT_EX_ZERO;
    e = ct_ex_subst(r->m->x, e, &r->m->time, &zero, 1);
    return ct_read_number(r, e, v) && isfinite(*v);
}

static bool check_start(struct ct_reader *r, const struct joint *j, size_t i, const char *key,
                        const struct ct_value *given, ct_ex driven)
{
    double v, d;
    if (!given->given || i >= given->n || given->hole[i] || !ct_read_number(r, given->e[i], &v)
        || !value_at_start(r, driven, &d))
        return true;
    // Derived: a start value printed with nine digits by a program that computed the driver
    if (fabs(v - d) <= 1e-9 * fmax(1, fabs(d)))
        return true;
    ct_error(r->ctx, given->at[i], CT_E_INITIAL,
             "joint '%s' starts with %s = %g by its motion, but 'initial' gives %g",
             j->self->name, key, d, v);
    ct_note(r->ctx, value_of(j, "motion")->at[i], "the motion is here");
    return false;
}

static bool check_driven_start(struct ct_reader *r, const struct joint *j)
{
    const struct ct_value *motion = value_of(j, "motion");
    const struct ct_initial *initial = &j->self->initial;
    bool ok = true;
    if (!motion->given || initial->guess || !motion->hole)
        return true;
    for (size_t i = 0; i < motion->n; i++) {
        if (motion->hole[i] || j->speed[i] == ROTATION)
            continue;
        ok &= check_start(r, j, i, "q", &initial->q, motion->e[i]);
        ok &= check_start(r, j, i, "u", &initial->u,
                          ct_ex_diff(r->m->x, motion->e[i], r->m->time));
    }
    return ok;
}

// ---- a joint -----------------------------------------------------------------------------------

// Two ends on one rigid body never move relative to each other; on one beam they do.
static bool check_two_bodies(struct ct_reader *r, const struct joint *j)
{
    const struct ct_frame *from = &r->m->frame[j->self->from], *to = &r->m->frame[j->self->to];
    const struct ct_body *body = &r->m->body[from->body];
    if (from->body != to->body || body->beam)
        return true;
    return ct_error(r->ctx, value_of(j, "to")->mark, CT_E_SAME_BODY,
                    "joint '%s': '%s' and '%s' are both on %s%s%s, so they cannot move against "
                    "each other; which other body does it join?",
                    j->self->name, from->name, to->name, from->body ? "body '" : "the ground",
                    from->body ? body->instance.name : "", from->body ? "'" : "");
}

static bool read_ends(struct ct_reader *r, struct joint *j)
{
    bool ok = true;
    for (int end = 0; end < 2; end++) {
        const char *name = end ? "to" : "from";
        const struct ct_node *node = ct_node_get(j->node, name);
        struct ct_value *v = value_of(j, name);
        if (!node)
            continue;
        v->given = true;
        v->mark = node->mark;
        ok &= ct_read_frame(r, node, &v->frame);
        *(end ? &j->self->to : &j->self->from) = v->frame;
    }
    if (j->self->from >= 0 && j->self->from == j->self->to)
        ok = ct_error(r->ctx, value_of(j, "to")->mark, CT_E_SAME_FRAME,
                      "joint '%s': 'from' and 'to' are the same frame '%s'", j->self->name,
                      r->m->frame[j->self->to].name);
    else if (j->self->from >= 0 && j->self->to >= 0)
        ok &= check_two_bodies(r, j);
    j->at_particle = is_particle_frame(r, j->self->from) || is_particle_frame(r, j->self->to);
    return ok;
}

static bool read_common(struct ct_reader *r, struct joint *j)
{
    int n;
    const struct ct_key *key = ct_family_keys(CT_FAMILY_JOINT, &n);
    bool ok = true;
    for (int i = 0; i < n; i++) {
        const struct ct_node_pair *p = ct_node_find(j->node, key[i].name);
        if (p && key[i].kind == CT_VALUE_COORDS)
            ok &= read_coords(r, j, &key[i], p);
        else if (p && key[i].kind == CT_VALUE_INITIAL)
            ok &= read_initial(r, j, p);
    }
    return ok;
}

static bool read_joint(struct ct_reader *r, struct ct_instance *self,
                       const struct ct_node *node)
{
    const struct ct_node_pair p = {self->name, self->mark, node};
    self->cls = ct_read_class(r, CT_FAMILY_JOINT, &p, "joint");
    if (!self->cls)
        return false;
    ct_read_alloc_values(r, self);
    struct joint j
        = {.self = self, .value = (struct ct_value *)(uintptr_t)self->value, .node = node};
    const bool framed = has_frames(self->cls);
    bool ok = ct_read_component_keys(r, self, node, "joint", framed);
    ok &= ct_read_own_values(r, self, node);
    if (framed)
        ok &= read_ends(r, &j);
    if (ok && framed) {
        count_coordinates(r, &j);
        ok = read_common(r, &j) && check_driven_start(r, &j);
    } else if (!ok) {
        self->ncoord = -1; // unknown: missing coordinates are then not reported
    }
    r->local_of = NULL;
    return ok;
}

// ---- gears: they name joints, so all joints come first -----------------------------------------

int ct_read_joint_name(struct ct_reader *r, const char *name, struct ct_mark at)
{
    const struct ct_model *m = r->m;
    const int joint = ct_model_find_joint(m, name);
    if (joint >= 0)
        return joint;
    const char *near = "";
    if (ct_read_wants_suggestions(r)) {
        const char **names = CT_NEWN(r->ctx->scratch, const char *, m->njoint);
        for (size_t i = 0; i < m->njoint; i++)
            names[i] = m->joint[i].name;
        near = ct_read_suggestion(r, name, names, m->njoint);
    }
    ct_error(r->ctx, at, CT_E_JOINT, "there is no joint '%s'%s", name, near);
    return -1;
}

// Resolve `a`, `a.q` or `a.q2` to joint and coordinate (from 0); errors are reported at the mark.
static bool read_coordinate(struct ct_reader *r, const char *text, struct ct_mark at,
                            int *joint, int *coordinate)
{
    const char *dot = strchr(text, '.');
    const char *name
        = dot ? ct_arena_strndup(r->ctx->scratch, text, (size_t)(dot - text)) : text;
    *joint = ct_read_joint_name(r, name, at);
    *coordinate = 0;
    if (*joint < 0)
        return false;
    const struct ct_instance *j = &r->m->joint[*joint];
    if (!j->cls || j->ncoord < 0)
        return false; // reported by the callee
    if (j->ncoord == 0)
        return ct_error(r->ctx, at, CT_E_JOINT, "joint '%s' (%s) has no coordinate", name,
                        j->cls->name);
    long k = 1;
    char *end = NULL;
    if (dot && dot[1] == 'q')
        k = dot[2] ? strtol(dot + 2, &end, 10) : 1;
    if (dot && (dot[1] != 'q' || (dot[2] && (*end || dot[2] < '1' || dot[2] > '9'))))
        return ct_error(r->ctx, at, CT_E_JOINT, "'%s' is no coordinate; write %s.q1", text,
                        name);
    if ((!dot || !dot[2]) && j->ncoord > 1)
        return ct_error(r->ctx, at, CT_E_JOINT,
                        "joint '%s' has %d coordinates; name one, as in %s.q2", name, j->ncoord,
                        name);
    if (k > j->ncoord)
        return ct_error(r->ctx, at, CT_E_JOINT, "joint '%s' has %d coordinate%s, no q%ld", name,
                        j->ncoord, j->ncoord == 1 ? "" : "s", k);
    if (j->ncoord != j->nfree && k > j->ncoord - 4)
        return ct_error(r->ctx, at, CT_E_JOINT,
                        "'%s' is part of a quaternion, not a coordinate of its own", text);
    *coordinate = (int)k - 1;
    return true;
}

// Replace the names by those that equations use for the coordinates.
static bool check_coupling(struct ct_reader *r, struct ct_value *v)
{
    const char **name = CT_NEWN(r->a, const char *, v->n);
    bool ok = true;
    int *joint = CT_NEWN(r->ctx->scratch, int, v->n),
        *coordinate = CT_NEWN(r->ctx->scratch, int, v->n);
    for (size_t i = 0; i < v->n; i++) {
        if (!v->name[i]
            || !read_coordinate(r, v->name[i], v->at[i], &joint[i], &coordinate[i])) {
            ok = false;
            joint[i] = -1;
        }
        name[i] = v->name[i];
        if (joint[i] >= 0
            && r->m->joint[joint[i]].ncoord == 1) // for one coordinate `q1` is `q`
            name[i] = r->m->joint[joint[i]].name;
        for (size_t k = 0; k < i; k++)
            if (joint[i] >= 0 && joint[k] == joint[i] && coordinate[k] == coordinate[i])
                ok = ct_error(r->ctx, v->at[i], CT_E_JOINT, "'%s' is coupled to itself",
                              v->name[i]);
    }
    v->name = name;
    return ok;
}

static void check_couplings(struct ct_reader *r, const struct ct_instance *self)
{
    int nfamily;
    ct_family_keys(CT_FAMILY_JOINT, &nfamily);
    for (int i = 0; self->cls && i < self->cls->nkey; i++)
        if (self->cls->key[i].kind == CT_VALUE_JOINTS && self->value[nfamily + i].given)
            check_coupling(r, (struct ct_value *)(uintptr_t)&self->value[nfamily + i]);
}

void ct_read_joints_fill(struct ct_reader *r)
{
    for (size_t i = 0; i < r->m->njoint; i++)
        read_joint(r, &r->m->joint[i], r->joint_node[i]);
    for (size_t i = 0; i < r->m->njoint; i++)
        check_couplings(r, &r->m->joint[i]);
}

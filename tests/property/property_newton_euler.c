// Newton and Euler for every body: the wrenches of its joints, as they are put out, and of the
// forces, worked out here from their laws, make up for its d'Alembert wrench.
#include "tests/property/system.h"
#include "tests/property/vector.h"

static const double tolerance = 1e-9; // solutions of small, well conditioned systems

struct scene {
    struct system *s;
    struct variant *v;
    double t;
    double *value;        // of the model's symbols
    struct vector *F, *T; // by body: sum of wrenches, torque about the ground origin
};

// ---- what the program says ----------------------------------------------------------------------

static double scalar_of(struct scene *c, const char *signal)
{
    return c->v->result[variant_result(c->v, signal)];
}

static struct vector signal_of(struct scene *c, const char *owner, const char *property)
{
    struct vector r;
    for (int i = 0; i < 3; i++)
        r.e[i] = scalar_of(c, text_of(c->v->arena, "%s.%s.%c", owner, property, "xyz"[i]));
    return r;
}

static const char *frame_name(const struct scene *c, int frame)
{
    return c->s->model.frame[frame].name;
}

static struct vector of_frame(struct scene *c, int frame, const char *property)
{
    const struct vector zero = {{0, 0, 0}};
    return frame <= 0 ? zero : signal_of(c, frame_name(c, frame), property);
}

// R v, or R' v with transposed.
static struct vector turned(struct scene *c, int frame, struct vector v, bool transposed)
{
    struct vector r = {{0, 0, 0}};
    if (frame <= 0)
        return v;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int row = transposed ? j : i, column = transposed ? i : j;
            r.e[i] += scalar_of(c, text_of(c->v->arena, "%s.rotation.%c%c",
                                           frame_name(c, frame), "xyz"[row], "xyz"[column]))
                    * v.e[j];
        }
    return r;
}

static void put_out_frame(struct system *s, int frame)
{
    static const char *const property[]
        = {"position", "velocity", "rotation", "angular_velocity"};
    for (size_t i = 0; i < COUNT(property) && frame > 0; i++)
        system_output(s,
                      text_of(s->ctx.model, "%s.%s", s->model.frame[frame].name, property[i]));
}

static void put_out_all(struct system *s)
{
    struct ct_model *m = &s->model;
    system_no_outputs(s);
    system_output_motion(s);
    system_output_reactions(s);
    for (size_t i = 0; i < m->njoint; i++) {
        put_out_frame(s, m->joint[i].from);
        put_out_frame(s, m->joint[i].to);
    }
    for (size_t i = 0; i < m->nforce; i++) {
        put_out_frame(s, m->force[i].from);
        put_out_frame(s, m->force[i].to);
        for (int k = 0; k < m->force[i].cls->nkey; k++)
            if (!strcmp(m->force[i].cls->key[k].name, "in"))
                put_out_frame(s, ct_instance_value(&m->force[i], "in")->frame);
    }
    const size_t nnode = m->x->nnode;
    for (uint32_t id = 0; id < nnode; id++) { // signals in expressions
        const struct ct_sym *sym = ct_ex_symbol(m->x, (ct_ex){id});
        if (sym && sym->kind == CT_SYM_SIGNAL
            && strchr(sym->name, '.') == strrchr(sym->name, '.')
            && !strstr(sym->name, "position")
            && ct_model_find_joint(
                   m, ct_arena_strndup(s->ctx.model, sym->name, strcspn(sym->name, ".")))
                   >= 0)
            system_output(s, sym->name);
    }
}

// ---- wrenches -----------------------------------------------------------------------------------

// Force at a place r and torque on a frame's body.
static void act(struct scene *c, int frame, struct vector F, struct vector T, struct vector r,
                double sign)
{
    const int body = frame < 0 ? 0 : c->s->model.frame[frame].body;
    c->F[body] = plus(c->F[body], sign, F);
    c->T[body] = plus(plus(c->T[body], sign, T), sign, cross(r, F));
}

static void act_pair(struct scene *c, int from, int to, struct vector F, struct vector T)
{
    const struct vector r = of_frame(c, to, "position");
    act(c, to, F, T, r, 1);
    act(c, from, F, T, r, -1);
}

static void act_joints(struct scene *c)
{
    for (size_t i = 0; i < c->s->model.njoint; i++) {
        const struct ct_instance *j = &c->s->model.joint[i];
        if (j->from < 0)
            continue;
        const struct vector F = turned(c, j->from, signal_of(c, j->name, "force"), false);
        const struct vector T = turned(c, j->from, signal_of(c, j->name, "torque"), false);
        act_pair(c, j->from, j->to, F, T);
    }
}

static double number(struct scene *c, const struct ct_instance *f, const char *key, int k)
{
    const struct ct_value *v = ct_instance_value(f, key);
    return v->given ? ct_ex_value(c->s->model.x, v->e[k], c->value) : 0;
}

static void act_spring(struct scene *c, const struct ct_instance *f)
{
    const struct vector zero = {{0, 0, 0}};
    const struct vector d
        = plus(of_frame(c, f->to, "position"), -1, of_frame(c, f->from, "position"));
    const struct vector v
        = plus(of_frame(c, f->to, "velocity"), -1, of_frame(c, f->from, "velocity"));
    const double l = sqrt(dot(d, d));
    const double pull = number(c, f, "stiffness", 0) * (l - number(c, f, "length", 0))
                      + number(c, f, "damping", 0) * dot(d, v) / l;
    act_pair(c, f->from, f->to, plus(zero, -pull / l, d), zero);
}

// Rotation vector between the axes of two frames, from the quaternion-free formula phi = t/sin(t)
// axial part.
static struct vector rotation_vector(struct scene *c, int from, int to)
{
    double R[3][3], trace = 0;
    for (int j = 0; j < 3; j++) {
        struct vector e = {{0, 0, 0}};
        e.e[j] = 1;
        const struct vector column = turned(c, from, turned(c, to, e, false), true);
        for (int i = 0; i < 3; i++)
            R[i][j] = column.e[i];
        trace += R[j][j];
    }
    const double angle = acos(fmax(-1, fmin(1, (trace - 1) / 2)));
    struct vector phi = {{R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]}};
    for (int i = 0; i < 3; i++)
        phi.e[i] *= angle > 1e-6 ? angle / (2 * sin(angle)) : 0.5;
    return phi;
}

static void act_bushing(struct scene *c, const struct ct_instance *f)
{
    struct vector F, T;
    const struct vector d
        = plus(of_frame(c, f->to, "position"), -1, of_frame(c, f->from, "position"));
    const struct vector w = of_frame(c, f->from, "angular_velocity");
    const struct vector v
        = plus(of_frame(c, f->to, "velocity"), -1, of_frame(c, f->from, "velocity"));
    const struct vector place = turned(c, f->from, d, true);
    const struct vector rate = turned(c, f->from, plus(v, -1, cross(w, d)), true);
    const struct vector spin
        = turned(c, f->from, plus(of_frame(c, f->to, "angular_velocity"), -1, w), true);
    const struct vector phi = rotation_vector(c, f->from, f->to);
    for (int i = 0; i < 3; i++) {
        F.e[i] = -number(c, f, "stiffness", i) * place.e[i]
               - number(c, f, "damping", i) * rate.e[i];
        T.e[i] = -number(c, f, "stiffness", 3 + i) * phi.e[i]
               - number(c, f, "damping", 3 + i) * spin.e[i];
    }
    act_pair(c, f->from, f->to, turned(c, f->from, F, false), turned(c, f->from, T, false));
}

static void act_applied(struct scene *c, const struct ct_instance *f)
{
    const struct vector zero = {{0, 0, 0}};
    struct vector v;
    for (int i = 0; i < 3; i++)
        v.e[i] = number(c, f, "value", i);
    v = turned(c, ct_instance_value(f, "in")->frame, v, false);
    const bool is_force = !strcmp(f->cls->name, "force");
    act(c, f->to, is_force ? v : zero, is_force ? zero : v, of_frame(c, f->to, "position"), 1);
}

static void act_forces(struct scene *c)
{
    for (size_t i = 0; i < c->s->model.nforce; i++) {
        const struct ct_instance *f = &c->s->model.force[i];
        if (!strcmp(f->cls->name, "spring"))
            act_spring(c, f);
        else if (!strcmp(f->cls->name, "bushing"))
            act_bushing(c, f);
        else
            act_applied(c, f);
    }
}

// Values of time, parameters and signals for the expressions of the model.
static void find_values(struct scene *c)
{
    struct ct_model *m = &c->s->model;
    c->value = CT_NEWN(c->v->arena, double, m->x->nsym + 1);
    for (uint32_t id = 0; id < m->x->nnode; id++) {
        const struct ct_sym *sym = ct_ex_symbol(m->x, (ct_ex){id});
        if (!sym)
            continue;
        double *value = &c->value[ct_ex_node(m->x, (ct_ex){id})->a];
        if (sym->kind == CT_SYM_TIME)
            *value = c->t;
        else if (sym->kind == CT_SYM_PARAM)
            *value = m->parameter[sym->index].value;
        else if (sym->kind == CT_SYM_SIGNAL)
            for (size_t i = 0; i < c->v->e.nresult; i++)
                if (!strcmp(c->v->e.result[i].name, sym->name))
                    *value = c->v->result[i];
    }
}

// ---- balance ------------------------------------------------------------------------------------

static struct vector body_vector(const struct ct_model *m, const ct_ex e[3])
{
    struct vector v;
    for (int i = 0; i < 3; i++)
        v.e[i] = ct_model_number(m, e[i]);
    return v;
}

static bool body_is_balanced(struct scene *c, size_t i, const struct vector *normal,
                             const char *how)
{
    const struct ct_model *m = &c->s->model;
    const struct ct_body *b = &m->body[i];
    const double mass = ct_model_number(m, b->mass);
    const struct vector r = of_frame(c, b->frame, "position"),
                        w = of_frame(c, b->frame, "angular_velocity"),
                        al = signal_of(c, b->instance.name, "angular_acceleration");
    const struct vector arm = turned(c, b->frame, body_vector(m, b->com.e), false);
    const struct vector place = plus(r, 1, arm);
    struct vector a = signal_of(c, b->instance.name, "acceleration");
    a = plus(plus(a, 1, cross(al, arm)), 1, cross(w, cross(w, arm)));
    // d'Alembert: m (a - g), I al + w x I w
    struct vector F = plus(a, -1, body_vector(m, m->gravity.e));
    for (int k = 0; k < 3; k++)
        F.e[k] *= mass;
    struct vector T = {{0, 0, 0}};
    if (!b->is_particle) {
        double I[6];
        for (int k = 0; k < 6; k++)
            I[k] = ct_model_number(m, b->inertia[k]);
        const struct vector al_b = turned(c, b->frame, al, true),
                            w_b = turned(c, b->frame, w, true);
        const int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
        struct vector Ia = {{0, 0, 0}}, Iw = Ia;
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) {
                Ia.e[k] += I[at[k][l]] * al_b.e[l];
                Iw.e[k] += I[at[k][l]] * w_b.e[l];
            }
        T = turned(c, b->frame, plus(Ia, 1, cross(w_b, Iw)), false);
    }
    const struct vector left = plus(c->F[i], -1, F);
    const struct vector moment = plus(plus(c->T[i], -1, cross(place, c->F[i])), -1, T);
    double scale = 1 + sqrt(dot(F, F)) + sqrt(dot(T, T));
    for (size_t k = 0; k < c->v->e.nresult; k++)
        if (strstr(c->v->e.result[k].name, ".force.")
            || strstr(c->v->e.result[k].name, ".torque."))
            scale = fmax(scale, fabs(c->v->result[k]));
    bool ok = true;
    if (normal)
        return agree(c->s->name,
                     text_of(c->v->arena, "moment on %s, %s", b->instance.name, how),
                     dot(moment, *normal), 0, scale, tolerance)
             & agree(c->s->name, text_of(c->v->arena, "force on %s, %s", b->instance.name, how),
                     sqrt(fabs(dot(left, left) - pow(dot(left, *normal), 2))), 0, scale, 1e-7);
    for (int k = 0; k < 3; k++) {
        ok &= agree(
            c->s->name,
            text_of(c->v->arena, "force %c on %s, %s", "xyz"[k], b -> instance.name, how),
            left.e[k], 0, scale, tolerance);
        // no joint gives a particle a moment; what passes through it is not seen there
        if (!b->is_particle)
            ok &= agree(
                c->s->name,
                text_of(c->v->arena, "moment %c on %s, %s", "xyz"[k], b -> instance.name, how),
                moment.e[k], 0, scale, tolerance);
    }
    return ok;
}

static bool bodies_are_balanced(struct system *s, const struct ct_formulate_options *o,
                                const char *how)
{
    struct variant v;
    bool ok = true;
    variant_open(s, o, &v);
    for (int k = 0; k < 2; k++) {
        struct scene c = {s, &v, 0.27 * (k + 1), NULL, NULL, NULL};
        struct ct_initial_state state;
        assert_true(system_random_state(s, c.t, 0.5, &state));
        variant_set(&v, &state, c.t);
        assert_true(variant_solve(&v));
        c.F = CT_NEWN(v.arena, struct vector, s->model.nbody);
        c.T = CT_NEWN(v.arena, struct vector, s->model.nbody);
        find_values(&c);
        act_joints(&c);
        act_forces(&c);
        struct vector n = {{0, 0, 0}};
        for (int i = 0; i < 3 && v.e.is_planar; i++)
            n.e[i] = ct_ex_value(v.e.x, v.e.build->topology->plane[2].e[i], v.e.build->value);
        for (size_t i = 1; i < s->model.nbody; i++)
            ok &= body_is_balanced(&c, i, v.e.is_planar ? &n : NULL, how);
    }
    variant_close(&v);
    return ok;
}

static bool system_is_balanced(struct system *s)
{
    put_out_all(s);
    bool ok = bodies_are_balanced(s, &by_joints, "joints");
    ok &= bodies_are_balanced(s, &by_bodies, "bodies");
    ok &= bodies_are_balanced(s, &by_choice, "choice");
    if (s->assembly.is_planar && s->model.nbody < 10) {
        system_keep_all(s);
        ok &= bodies_are_balanced(s, &by_joints_spatial, "joints, spatial");
        ok &= bodies_are_balanced(s, &by_bodies_spatial, "bodies, spatial");
    }
    return ok;
}

static void bodies_of_shipped_systems_are_balanced(void **state)
{
    (void)state;
    chance_start();
    assert_true(holds_for_shipped(system_is_balanced, 20));
}

static void bodies_of_every_mechanism_are_balanced(void **state)
{
    (void)state;
    chance_start();
    assert_true(holds_for_mechanisms(system_is_balanced, 0xff));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_of_shipped_systems_are_balanced),
        cmocka_unit_test(bodies_of_every_mechanism_are_balanced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

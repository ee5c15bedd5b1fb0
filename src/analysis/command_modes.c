// Analysis `modes`: the natural motions about a configuration as a table, as shapes and as a
// picture.
#include "analysis/modes.h"
#include "base/pi.h"

#include "analysis/eigenvalues.h"
#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/kinematics.h"
#include "report/archive.h"
#include "report/json.h"
#include "report/mode_shape_plot.h"
#include "report/columns.h"
#include "report/outfile.h"

#include <math.h>
#include <string.h>

// Default: number of modes that are listed (docs/cli.md). Test: analyses.
enum { STANDARD_COUNT = 10 };
enum { MOST_PANELS = 12 }; // Layout: modes that are drawn

// ---- finding the modes ---------------------------------------------------------------------

// With sparse matrices if possible, otherwise with dense ones.
static bool solve(struct ct_modes *s, size_t count)
{
    struct ct_arena *a = s->own.model;
    bool applies = false;
    if (s->at.is_large
        && !ct_sparse_modes(&s->own, a, s->at.l, count, &s->mode, &s->all, &s->how, &applies))
        return false;
    if (applies)
        return true;
    if (s->at.is_large && !ct_configuration_find_full(&s->own, s->system, &s->run, &s->at))
        return false;
    return ct_modes_solve(&s->own, a, s->at.l, &s->mode, &s->all, &s->how);
}

// Reports that no freedom is left: drivers prescribe all motion, or loops allow none.
static bool report_no_freedom(struct ct_modes *s)
{
    const struct ct_model *m = &s->system->model;
    for (size_t i = 0; i < m->njoint; i++)
        if (m->joint[i].cls->motion && ct_instance_value(&m->joint[i], "motion")->given)
            return ct_error(&s->own, ct_instance_value(&m->joint[i], "motion")->mark,
                            CT_E_NO_FREEDOM,
                            "there are no modes: motions drive all freedoms, this one that of "
                            "joint '%s'; a 'stiffness' in its place lets it vibrate",
                            m->joint[i].name);
    return ct_error(&s->own, (struct ct_mark){.file = m->file}, CT_E_NO_FREEDOM,
                    "there are no modes: the joints leave nothing free to vibrate");
}

static bool find(void *task)
{
    struct ct_modes *s = task;
    if (s->count < 0)
        return ct_error(&s->own, (struct ct_mark){0}, CT_E_USAGE,
                        "the number of modes is %ld; it must be greater than 0", s->count);
    const size_t wanted = s->count ? (size_t)s->count : STANDARD_COUNT;
    s->system = ct_system_borrow(&s->own, s->system);
    s->at.may_be_large = true;
    if (!ct_configuration_find(&s->own, s->system, &s->run, &s->at) || !solve(s, wanted))
        return false;
    if (!s->all)
        return report_no_freedom(s);
    s->n = s->all < wanted ? s->all : wanted;
    const int nu = s->at.l->nu;
    s->coordinate = CT_NEWN(s->own.model, const char *, nu + 1);
    for (int k = 0; k < nu; k++)
        s->coordinate[k] = ct_linear_coordinate(s->at.e, s->own.model, k);
    return true;
}

struct ct_modes *ct_modes_create(struct ct_ctx *ctx, struct ct_system *sys,
                                 const struct ct_modes_options *options)
{
    struct ct_modes_options o;
    ct_options_take(&o, options, sizeof o);
    struct ct_modes *s = ctx && sys ? ct_own_alloc(ctx, sizeof *s) : NULL;
    if (!s)
        return NULL;
    *s = (struct ct_modes){.system = sys,
                           .run = o.run,
                           .count = o.count,
                           .at = {.about = o.about, .hold_drivers = o.hold_drivers}};
    return ct_analysis_find(ctx, s, &s->own, &s->at, find);
}

void ct_modes_destroy(struct ct_modes *s)
{
    if (s)
        ct_analysis_free(s, &s->own, &s->at);
}

// ---- access --------------------------------------------------------------------------------

size_t ct_modes_count(const struct ct_modes *s)
{
    if (!s)
        return 0;
    return s->n;
}

struct ct_mode_info ct_modes_info(const struct ct_modes *s, size_t i)
{
    if (!s)
        return (struct ct_mode_info){0};
    if (i >= s->n)
        return (struct ct_mode_info){0};
    const struct ct_motion_mode *m = &s->mode[i];
    const double omega = hypot(m->re, m->im);
    return (struct ct_mode_info){.frequency_hz = omega / (2 * CT_PI),
                                 .omega = omega,
                                 .damping = m->re != 0 ? -m->re / omega : 0,
                                 .re = m->re,
                                 .im = m->im};
}

bool ct_modes_shape(const struct ct_modes *s, size_t i, const char *coordinate, double *re,
                    double *im)
{
    if (!s || !coordinate || !re || !im)
        return false;
    const int nu = s->at.l->nu;
    for (int k = 0; k < nu && i < s->n; k++)
        if (strcmp(s->coordinate[k], coordinate) == 0) {
            *re = s->mode[i].shape[k];
            *im = s->mode[i].shape[k + nu];
            return true;
        }
    return false;
}

// ---- tables ---------------------------------------------------------------------------------

struct output {
    struct ct_ctx *ctx;
    const struct ct_modes *s;
    const char *path;
};

static bool write_csv(const struct output *o)
{
    static const char *const names[] = {"mode", "frequency_hz", "omega_rad_s", "damping"};
    struct ct_columns table;
    ct_columns_init(&table, o->ctx->model, names[0], CT_COLUMN_INTEGER);
    for (size_t c = 1; c < COUNT(names); c++)
        ct_columns_add(&table, names[c], CT_COLUMN_NUMBER);
    for (size_t i = 0; i < o->s->n; i++) {
        const struct ct_mode_info m = ct_modes_info(o->s, i);
        ct_columns_number(&table, 0, (double)(i + 1));
        ct_columns_number(&table, 1, m.frequency_hz);
        ct_columns_number(&table, 2, m.omega);
        ct_columns_number(&table, 3, m.damping);
    }
    return ct_columns_write(o->ctx, &table, o->path);
}

static void write_mode(struct ct_json *j, const struct ct_modes *s, size_t i)
{
    const struct ct_mode_info m = ct_modes_info(s, i);
    const size_t nu = (size_t)s->at.l->nu;
    ct_json_object(j, NULL);
    ct_json_integer(j, "mode", (long long)i + 1);
    ct_json_number(j, "frequency_hz", m.frequency_hz);
    ct_json_number(j, "omega_rad_s", m.omega);
    ct_json_number(j, "damping", m.damping);
    ct_json_numbers(j, "eigenvalue", (double[]){m.re, m.im}, 2);
    ct_json_numbers(j, "shape_real", s->mode[i].shape, nu);
    ct_json_numbers(j, "shape_imaginary", s->mode[i].shape + nu, nu);
    ct_json_end(j);
}

static bool write_json(const struct output *o)
{
    struct ct_outfile file;
    struct ct_json j;
    if (!ct_outfile_open(o->ctx, &file, o->path))
        return false;
    ct_json_init(&j, file.stream);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", o->s->system->model.name);
    ct_json_text(&j, "about", o->s->at.about);
    ct_json_array(&j, "coordinates");
    for (int k = 0; k < o->s->at.l->nu; k++)
        ct_json_text(&j, NULL, o->s->coordinate[k]);
    ct_json_end(&j);
    ct_json_array(&j, "modes");
    for (size_t i = 0; i < o->s->n; i++)
        write_mode(&j, o->s, i);
    ct_json_end(&j);
    ct_json_end(&j);
    return ct_outfile_close(o->ctx, &file);
}

// Shapes as matrices with a column for each mode, a row for each coordinate.
static bool write_archive(const struct output *o, enum ct_suffix suffix)
{
    const struct ct_modes *s = o->s;
    const size_t nu = (size_t)s->at.l->nu, n = s->n;
    struct ct_arena *a = o->ctx->model;
    double *table = CT_NEWN(a, double, 5 * n + 1), *shape = CT_NEWN(a, double, 2 * nu * n + 1);
    static const char *const names[]
        = {"frequency_hz", "omega_rad_s", "damping", "eigenvalue_real", "eigenvalue_imaginary"};
    struct ct_outfile file;
    struct ct_archive z;
    for (size_t i = 0; i < n; i++) {
        const struct ct_mode_info m = ct_modes_info(s, i);
        const double value[] = {m.frequency_hz, m.omega, m.damping, m.re, m.im};
        for (size_t k = 0; k < COUNT(names); k++)
            table[i + n * k] = value[k];
        memcpy(shape + nu * i, s->mode[i].shape, nu * sizeof *shape);
        memcpy(shape + nu * (n + i), s->mode[i].shape + nu, nu * sizeof *shape);
    }
    if (!ct_outfile_open(o->ctx, &file, o->path))
        return false;
    ct_archive_init(&z, a, suffix, &file);
    for (size_t k = 0; k < COUNT(names); k++)
        ct_archive_vector(&z, names[k], table + n * k, n);
    ct_archive_matrix(&z, "shape_real", shape, nu, n);
    ct_archive_matrix(&z, "shape_imaginary", shape + nu * n, nu, n);
    ct_archive_names(&z, "coordinates", s->coordinate, nu);
    if (ct_archive_finish(o->ctx, &z))
        return ct_outfile_close(o->ctx, &file);
    ct_outfile_discard(&file);
    return false;
}

static bool write_modes(void *task)
{
    const struct output *o = task;
    enum ct_suffix suffix;
    if (!ct_suffix_read(o->ctx, o->path, CT_SUFFIX_TABLE, &suffix))
        return false;
    return suffix == CT_SUFFIX_JSON                           ? write_json(o)
         : suffix == CT_SUFFIX_NPZ || suffix == CT_SUFFIX_MAT ? write_archive(o, suffix)
                                                              : write_csv(o);
}

bool ct_modes_write(struct ct_ctx *ctx, const struct ct_modes *modes, const char *path)
{
    if (!ctx || !modes)
        return false;
    struct output o = {ctx, modes, path};
    return modes && ct_enter(ctx, write_modes, &o);
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_modes *s = object;
    ct_configuration_print(&s->at, out);
    fprintf(out, "%-14s%d, %s eigenvalue problem; %zu of %zu modes\n",
            s->at.l->nfree ? "freedoms" : "speeds",
            s->at.l->nfree ? s->at.l->nfree - (int)s->at.e->nstate : s->at.l->nu, s->how, s->n,
            s->all);
}

void ct_modes_print_summary(const struct ct_modes *s, FILE *out)
{
    ct_print_to(out, print_summary, s);
}

char *ct_modes_summary(const struct ct_modes *s)
{
    return ct_print_text(print_summary, s);
}

// ---- the picture ---------------------------------------------------------------------------

// Points of the line drawing, as coordinates along the two directions of the view: first the
// nodes of the graph, then points along the axes of beams.
struct skeleton {
    struct ct_modes *s;
    struct ct_program places;
    size_t n;
    struct ct_bone *bone;
    size_t nbone, bone_cap;
};

// Directions of the view: the plane of a planar mechanism, otherwise an oblique view from
// above.
static void view_directions(struct ct_build *b, ct_ex3 *right, ct_ex3 *up)
{
    static const double side[3] = {-0.5, 0.8660254037844386, 0};
    static const double rise[3] = {-0.4330127018922193, -0.25, 0.8660254037844386};
    *right = b->topology->is_planar ? b->topology->plane[0] : ct_ex3_const(b->x, side);
    *up = b->topology->is_planar ? b->topology->plane[1] : ct_ex3_const(b->x, rise);
}

static void add_bones(struct skeleton *k, const struct ct_build *b)
{
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const enum ct_edge_kind kind = b->topology->edge[i].kind;
        const struct ct_bone bone = {.from = b->topology->wiring[i].tail,
                                     .to = b->topology->wiring[i].head,
                                     .kind = kind == CT_EDGE_ARM   ? CT_BONE_BODY
                                           : kind == CT_EDGE_FORCE ? CT_BONE_FORCE
                                                                   : CT_BONE_JOINT};
        const bool hangs = kind == CT_EDGE_FORCE && bone.from == 0; // a load, not a spring
        if (kind != CT_EDGE_BODY && !hangs && b->topology->edge[i].beam < 0)
            CT_PUSH(k->s->own.model, k->bone, k->nbone, k->bone_cap, bone);
    }
}

static int points_of_beam(const struct ct_flexible *f)
{
    // Layout: points along a beam
    enum { FEWEST = 40, MOST = 400 };
    const int n = f->beam->nelement;
    return 1 + (n >= MOST ? MOST : n * (n >= FEWEST ? 1 : (FEWEST + n - 1) / n));
}

// The axis of a beam as a polyline, whose points are stored from index `at` on.
static void add_axis(struct skeleton *k, struct ct_build *b, const struct ct_flexible *f,
                     int at, ct_ex3 *place)
{
    const int n = points_of_beam(f);
    const ct_ex3 base = ct_node_position(b, f->base);
    for (int i = 0; i < n; i++) {
        struct ct_station s;
        ct_flexible_station(b, f, ct_ex_scale(b->x, (double)i / (n - 1), f->beam->length),
                            f->kinematics, &s);
        place[at + i] = ct_ex3_add(b->x, base, ct_node_turn(b, f->base, s.position));
        const struct ct_bone bone = {.from = at + i - 1, .to = at + i, .kind = CT_BONE_BODY};
        if (i > 0)
            CT_PUSH(k->s->own.model, k->bone, k->nbone, k->bone_cap, bone);
    }
}

static void skeleton_create(struct skeleton *k, struct ct_modes *s)
{
    struct ct_build *b = s->at.e->build;
    struct ct_arena *a = s->own.model;
    ct_ex3 right, up;
    *k = (struct skeleton){.s = s, .n = b->topology->nnode};
    for (size_t i = 0; i < b->nflexible; i++)
        k->n += (size_t)points_of_beam(&b->flexible[i]);
    ct_ex *place = CT_NEWN(a, ct_ex, 2 * k->n + 1);
    ct_ex3 *r = CT_NEWN(a, ct_ex3, k->n + 1);
    view_directions(b, &right, &up);
    for (size_t i = 0; i < b->topology->nnode; i++)
        r[i] = ct_node_position(b, (int)i);
    int at = (int)b->topology->nnode;
    for (size_t i = 0; i < b->nflexible; at += points_of_beam(&b->flexible[i++]))
        add_axis(k, b, &b->flexible[i], at, r);
    for (size_t i = 0; i < k->n; i++) {
        place[2 * i] = ct_ex3_dot(b->x, right, r[i]);
        place[2 * i + 1] = ct_ex3_dot(b->x, up, r[i]);
    }
    ct_evaluator_add_program(a, s->at.l->m, b->x, place, 2 * k->n, &k->places);
    add_bones(k, b);
}

void ct_modes_displace(struct ct_modes *s, const double *y0, const double *shape, double amount)
{
    struct ct_linear *l = s->at.l;
    double *dq = CT_NEWN(s->own.scratch, double, l->nu + 1);
    memcpy(l->y, y0, (l->m->nq + l->m->nu + 1) * sizeof *y0);
    for (int i = 0; i < l->nu; i++)
        dq[i] = amount * shape[i];
    ct_evaluator_retract(l->m, l->y, dq);
    ct_linear_close(l); // if the loops do not close, the last iterate is drawn
    ct_evaluator_set(l->m, l->t, l->y);
}

// Points (2 x n, out) after the coordinates have moved by `amount` times a shape.
static void points_of(struct skeleton *k, const double *y0, const double *shape, double amount,
                      double *out)
{
    ct_modes_displace(k->s, y0, shape, amount);
    ct_program_run(&k->places, k->s->at.l->m->input);
    memcpy(out, k->places.out, 2 * k->n * sizeof *out);
}

// Scales the displacements p - rest (2 x n each, p in and out) of a small motion by `factor`.
// The motion must be small: in a large one, beams whose shape is large against its wavelength
// would be drawn shortened and folded.
static void enlarge(double *p, const double *rest, size_t n, double factor)
{
    for (size_t i = 0; i < 2 * n; i++)
        p[i] = rest[i] + factor * (p[i] - rest[i]);
}

static double farthest(const double *p, const double *q, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, hypot(p[2 * i] - q[2 * i], p[2 * i + 1] - q[2 * i + 1]));
    return most;
}

static double extent(const double *p, size_t n)
{
    double most = 0;
    for (size_t i = 1; i < n; i++)
        most = fmax(most, hypot(p[2 * i] - p[0], p[2 * i + 1] - p[1]));
    return most;
}

static bool draw(struct ct_ctx *ctx, struct ct_modes *s, const char *path)
{
    struct ct_arena *a = s->own.model;
    // Layout: size of a mode relative to the picture. Derived: differences at 1e-4 keep six
    // digits.
    const double visible = 0.15, small = 1e-4, largest_turn = 0.5;
    struct skeleton k;
    skeleton_create(&k, s);
    const size_t npanel = s->n < MOST_PANELS ? s->n : MOST_PANELS,
                 ny = s->at.l->m->nq + s->at.l->m->nu + 1;
    struct ct_shape_panel *panel = CT_NEWN(a, struct ct_shape_panel, npanel + 1);
    double *y0 = CT_NEWN(a, double, ny), *rest = CT_NEWN(a, double, 2 * k.n + 1);
    memcpy(y0, s->at.l->y, ny * sizeof *y0);
    points_of(&k, y0, y0, 0, rest);
    for (size_t i = 0; i < npanel; i++) {
        double *p = CT_NEWN(a, double, 2 * k.n + 1);
        const struct ct_mode_info m = ct_modes_info(s, i);
        points_of(&k, y0, s->mode[i].shape, small, p);
        // Layout: of the picture
        // rotating sections do not show as displacement
        const double size = extent(rest, k.n), unseen = 1e-6 * small * size,
                     far = farthest(p, rest, k.n), moved = far > unseen ? far / small : 0;
        const double amount = moved > 0 ? fmin(visible * size / moved, largest_turn) : 0;
        if (s->at.e->build->nflexible)
            enlarge(p, rest, k.n, moved > 0 ? visible * size / (moved * small) : 0);
        else
            points_of(&k, y0, s->mode[i].shape, amount, p);
        panel[i].point = p;
        const char *turns = moved > 0 ? "" : ", turns about its axis";
        panel[i].title = m.damping != 0
                           ? ct_arena_printf(a, "%zu: %.4g Hz, damping %.3g%s", i + 1,
                                             m.frequency_hz, m.damping, turns)
                           : ct_arena_printf(a, "%zu: %.4g Hz%s", i + 1, m.frequency_hz, turns);
    }
    memcpy(s->at.l->y, y0, ny * sizeof *y0);
    ct_evaluator_remove_program(s->at.l->m, &k.places);
    return ct_shapes_draw(ctx, path, s->system->model.name, panel, npanel, rest, k.n, k.bone,
                          k.nbone);
}

static bool draw_modes(void *task)
{
    const struct output *o = task;
    struct ct_modes *s = (struct ct_modes *)(uintptr_t)o->s;
    return draw(o->ctx, s, o->path);
}

bool ct_modes_draw(struct ct_ctx *ctx, struct ct_modes *modes, const char *path)
{
    if (!ctx || !modes || !path)
        return false;
    struct output o = {ctx, modes, path};
    return modes && ct_enter(ctx, draw_modes, &o);
}

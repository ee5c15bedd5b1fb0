// See embedding.h: closed forms, which to use, and whether their pivots are still in a good order.
#include "solve/embedding.h"

#include <math.h>
#include <string.h>

// So many weak checks in a row ask for another order.
enum { MOST_WEAK = 3 };
// As long as the strength of the pivots is that of when they left such a part of what is allowed, or less, they are checked
// after every eighth projection.
static const double well_below = 0.1;
enum { UNCHECKED = 7 };

static struct ct_partition partition(const struct ct_embed *s)
{
    return (struct ct_partition){s->row, s->dependent, s->independent, (size_t)s->rank,
                                 s->m->nu - (size_t)s->rank};
}

// Operations of embedding by matrices, (6.2), for n speeds, r kept rows, f = n - r freedoms: LU of J_d, its
// solutions, products M B and B' M B, Cholesky of the reduced mass matrix.
double ct_embed_operations(const struct ct_embed *s)
{
    const double n = (double)s->m->nu, r = s->rank, f = n - r;
    const double lu = 2 * r * r * r / 3 + 2 * r * r * (f + 1);
    const double right = 2 * n * r + 2 * r * f;
    const double reduced = r > 0 ? 2 * n * r * f + r * f * (f + 1) : 0;
    return lu + right + reduced + f * f * f / 3 + 2 * f * f + 2 * r * f;
}

// form[i] comes first, the others move behind it.
static void put_first(struct ct_embed *s, size_t i)
{
    struct ct_form *f = s->form[i];
    memmove(s->form + 1, s->form, i * sizeof *s->form);
    s->form[0] = f;
}

// In the place of form[0], if that is for the rows and columns of now; the order of pivots is sought at the
// machine's input.
static void make_form(struct ct_embed *s)
{
    const struct ct_partition p = partition(s);
    if (s->has_form || s->nform == CT_MOST_FORMS) {
        put_first(s, s->has_form ? 0 : s->nform - 1);
        ct_form_destroy(s->m, s->form[0]);
        memmove(s->form, s->form + 1, --s->nform * sizeof *s->form);
    }
    ct_machine_motion(s->m);
    struct ct_form_costs costs = {0};
    struct ct_form *f = s->is_asked ? ct_form_ask(s->arena, s->m, &p, s->kind)
                                    : ct_form_create(s->arena, s->m, &p, ct_embed_operations(s),
                                                     s->kind, &costs);
    if (s->nmade == 0 && !s->is_asked)
        s->costs = costs;
    s->solves.reordered += s->nmade++ > 0;
    s->has_form = f != NULL;
    if (f) {
        s->kind = f->kind;
        s->form[s->nform] = f;
        put_first(s, s->nform++);
    }
}

// Projections to wait for with weak pivots, or without a form, until one is made: more and more, so that a motion
// that changes its rows and columns all the time does not spend its time on forms.
static long patience(const struct ct_embed *s)
{
    const long doublings = s->nmade / CT_MOST_FORMS;
    return 1L << (doublings < 16 ? doublings : 16);
}

static void forget_strength(struct ct_embed *s)
{
    s->nweak = s->nunchecked = 0;
    s->strength.at_sigma = 0;
    s->strength.is_alike = false;
}

void ct_embed_take_form(struct ct_embed *s)
{
    const struct ct_partition p = partition(s);
    size_t i = 0;
    s->has_form = s->is_rough = false;
    forget_strength(s);
    if (!s->m->nrow || s->is_dear)
        return;
    while (i < s->nform && !ct_form_is_for(s->form[i], &p))
        i++;
    if (i < s->nform) {
        s->has_form = true;
        put_first(s, i);
    } else if (patience(s) == 1) {
        make_form(s);
        s->is_dear = s->nmade == 1 && !s->has_form;
    }
}

void ct_embed_stay_dense(struct ct_embed *s)
{
    s->is_dear = true;
    s->has_form = false;
}

void ct_embed_use(struct ct_embed *s, const struct ct_form_kind *kind)
{
    s->kind = kind;
    s->is_asked = kind != NULL;
    if (!kind)
        ct_embed_stay_dense(s);
}

bool ct_embed_is_sound(const struct ct_embed *s)
{
    double low, high;
    ct_strength_range(&s->strength, &low, &high);
    return s->strength.now > low && s->strength.now < high;
}

bool ct_embed_is_form_due(const struct ct_embed *s)
{
    return s->has_form && s->nweak == 0 && (s->strength.is_alike || !s->is_delicate);
}

void ct_embed_follow_sigma(struct ct_embed *s)
{
    if (s->strength.is_alike)
        s->sigma = ct_strength_sigma(&s->strength);
}

// Inertias of a form tell what they are of those elsewhere, not what has cancelled in them: before less is left of any than may be, matrices
// tell.
static const double wary = 10;

static bool has_one_freedom(const struct ct_embed *s)
{
    return s->least_left > 0 && (size_t)s->rank + 1 == s->m->nu;
}

// u' by the form of now; false if its pivots are not sound here.
static bool solve_form(struct ct_embed *s)
{
    struct ct_form *f = s->form[0];
    f->least_part = has_one_freedom(s) ? wary * s->least_left : 0;
    s->strength.now = ct_form_solve(f, s->m, s->a);
    if (!ct_embed_is_sound(s) || f->has_fallen)
        return false;
    ct_embed_follow_sigma(s);
    s->solves.fixed++;
    if (!s->is_rough)
        return true;
    ct_form_check(f, s->m);
    s->solves.refined++;
    memcpy(s->a, f->a, s->m->nu * sizeof *s->a);
    return f->left_better <= ct_left_most;
}

enum ct_eval ct_embed_solve(struct ct_embed *s)
{
    struct ct_machine *m = s->m;
    if (ct_machine_solved(m, s->a))
        return CT_EVAL_OK;
    const bool is_tried = ct_embed_is_form_due(s);
    if (is_tried && solve_form(s))
        return CT_EVAL_OK;
    ct_machine_motion(m);
    s->solves.pivoted++;
    const enum ct_eval e = ct_embed_accelerate(s);
    if (e == CT_EVAL_OK && has_one_freedom(s))
        s->left = fmin(s->left, ct_embed_left(s));
    if (s->has_form && !is_tried)
        s->strength.now = ct_form_close(s->form[0], m);
    if (s->has_form)
        ct_strength_compare(&s->strength, s->sigma);
    return e;
}

// After a projection, at the machine's input: are the pivots still in a good order? Beside a singular position, where answers grow
// whatever is chosen, choices had better stay.
static void check_form(struct ct_embed *s)
{
    struct ct_form *f = s->form[0];
    if (s->nunchecked > 0 && ct_is_within(s->strength.now / s->checked_at, ct_same_strength)
        && (s->answer <= ct_answer_growth * s->answer_checked
            || s->nearness < ct_small_pivot)) {
        s->nunchecked--;
        return;
    }
    s->answer_checked = s->answer > 0 ? s->answer : s->answer_checked;
    ct_form_check(f, s->m);
    s->is_rough = f->left > ct_left_plain;
    s->nunchecked = f->left <= well_below * ct_left_plain ? UNCHECKED : 0;
    s->checked_at = s->strength.now;
    if (s->strength.now > ct_form_weakest && f->left_better <= ct_left_most) {
        s->kappa = isnan(f->kappa) ? s->kappa : f->kappa;
        s->nweak = 0;
    } else if (++s->nweak >= MOST_WEAK * patience(s)) {
        make_form(s);
        forget_strength(s);
    }
}

void ct_embed_tend_form(struct ct_embed *s)
{
    if (!s->m->nrow || s->is_dear || (s->is_delicate && !s->strength.is_alike))
        return;
    if (s->has_form)
        check_form(s);
    else if (++s->nweak >= patience(s)) {
        make_form(s);
        forget_strength(s);
    }
}

bool ct_embed_form_multipliers(struct ct_embed *s)
{
    struct ct_form *f = s->form[0];
    if (!ct_embed_is_form_due(s) || s->rank < (int)s->m->nrow || !ct_embed_is_sound(s))
        return false;
    ct_form_check(f, s->m);
    memcpy(s->lam, f->lam, s->m->nrow * sizeof *s->lam); // all rows are kept, in their order
    return f->left_better <= ct_left_most;
}

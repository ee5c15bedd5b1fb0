// Embedding from inside: what its files share.
//
//     embed.c           accelerations, multipliers and speeds after jumps, by dense matrices
//     embed_choose.c    independent rows and dependent columns
//     embed_form.c      the same in closed form, where that is sound
//     embed_project.c   onto the constraints
//     embed_pivot.c     how near J is to losing rank
//     embed_side.c      whether it has lost rank between two places
//     embed_inertia.c   what inertia some speeds have where others are free to follow
#ifndef CT_SOLVE_EMBEDDING_H
#define CT_SOLVE_EMBEDDING_H

#include "solve/embed.h"

static inline double *ct_embed_J(const struct ct_embed *s, int row, int column)
{
    return &s->m->J[(size_t)row + s->m->nrow * (size_t)column];
}

static inline bool ct_embed_has_redundant_rows(const struct ct_embed *s)
{
    return s->rank < (int)s->m->nrow;
}

/// LU of J_d and B = -J_d^-1 J_i (rank x free); false if J_d is singular.
bool ct_embed_factor(struct ct_embed *s);
/// The same at a place that need not be one of the motion: kappa and sigma of that stay.
bool ct_embed_factor_aside(struct ct_embed *s);
/// S (free x free) = B' M B with the unit columns of the independent speeds, its lower triangle.
void ct_embed_reduce_mass(struct ct_embed *s, const double *M);
/// After ct_embed_accelerate with one freedom: B' M B against what its terms add up to before motions that constraints forbid cancel.  (8.39)
double ct_embed_left(const struct ct_embed *s);
/// Dense factors of larger systems cost more than a step does.
bool ct_embed_is_large(const struct ct_embed *s);

/// The form for the rows and columns of now: one from before, or a new one.
void ct_embed_take_form(struct ct_embed *s);
/// Can the form of now be tried? Beside singular positions only where it tells how near they are.
bool ct_embed_is_form_due(const struct ct_embed *s);
/// Were its pivots sound where it was used last?
bool ct_embed_is_sound(const struct ct_embed *s);
/// sigma from their strength, where that stands for it.
void ct_embed_follow_sigma(struct ct_embed *s);
/// Multipliers of all rows by the form of now, where they are unique.
bool ct_embed_form_multipliers(struct ct_embed *s);
/// After a projection, at the machine's input: checks the form of now, or makes one that is due.
void ct_embed_tend_form(struct ct_embed *s);

#endif

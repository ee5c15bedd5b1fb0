// See abreast.h.
#include "solve/abreast.h"

struct ct_abreast *ct_abreast_create(struct ct_arena *a, const struct ct_listing *l,
                                     size_t ninput)
{
    struct ct_abreast *s = CT_NEW(a, struct ct_abreast);
    s->listing = l;
    s->ninput = ninput;
    s->input = ct_arena_line(a, CT_ABREAST * ninput * sizeof *s->input);
    s->out = ct_arena_line(a, CT_ABREAST * l->nout * sizeof *s->out);
    return s;
}

void ct_abreast_use(struct ct_arena *a, struct ct_abreast *s, bool native, const double *input)
{
    if (!native)
        s->native = NULL;
    else if (!s->native)
        s->native = ct_native_create(a, s->listing, CT_ABREAST);
    if (!s->native && !s->tape)
        s->tape = ct_tape_create(a, s->listing);
    const size_t most
        = s->native ? ct_native_work(s->native) : CT_ABREAST * ct_tape_work(s->tape);
    if (most >= s->nwork) {
        s->nwork = most + 1;
        s->work = ct_arena_line(a, s->nwork * sizeof *s->work);
    }
    ct_abreast_prepare(s, input);
}

void ct_abreast_spread(struct ct_abreast *s, const double *input, size_t first)
{
    for (size_t i = first; i < s->ninput; i++)
        for (size_t point = 0; point < CT_ABREAST; point++)
            s->input[CT_ABREAST * i + point] = input[i];
}

void ct_abreast_prepare(struct ct_abreast *s, const double *input)
{
    ct_abreast_spread(s, input, 0);
    if (s->native)
        ct_native_prepare(s->native, s->input, s->work);
    else
        ct_tape_prepare_lanes(s->tape, CT_ABREAST, s->input, s->work);
}

void ct_abreast_run(struct ct_abreast *s)
{
    if (s->native)
        ct_native_eval(s->native, s->input, s->out, s->work);
    else
        ct_tape_eval_lanes(s->tape, CT_ABREAST, s->input, s->out, s->work);
}

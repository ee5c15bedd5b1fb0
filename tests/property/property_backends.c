// Motion and constraint programs of every shipped system have the same bits on every back end: tape
// and native code, one lane and several, compiled C.
#include "codegen/c.h"
#include "codegen/native.h"
#include "tests/own_sincos.h"
#include "tests/property/system.h"

#include <dlfcn.h>
#include <unistd.h>

enum { NLANE = 8 };

// The inputs of NLANE random states, in lanes: the assembled one with every entry moved a little.
static double *random_inputs(struct variant *v)
{
    const struct ct_evaluator *m = v->m;
    double *input = CT_NEWN(v->arena, double, NLANE * m->ninput);
    for (size_t k = 0; k < m->ninput; k++)
        for (size_t i = 0; i < NLANE; i++)
            input[NLANE * k + i] = m->input[k] + (k < m->at_q ? 0 : 0.1 * chance());
    return input;
}

// Lanes first ... first + n of inputs or outputs, in lanes of their own.
static void take_lanes(double *to, const double *from, size_t nvalue, size_t first, size_t n)
{
    for (size_t k = 0; k < nvalue; k++)
        memcpy(to + n * k, from + NLANE * k + first, n * sizeof *to);
}

static bool same_bits(const char *system, const char *who, const double *got,
                      const double *want, size_t nvalue, size_t lanes)
{
    for (size_t i = 0; i < lanes * nvalue; i++)
        if (memcmp(&got[i], &want[i], sizeof *got)
            && !(got[i] != got[i] && want[i] != want[i])) {
            print_error("%s: %s, output %zu: got %.17g, wanted %.17g\n", system, who, i / lanes,
                        got[i], want[i]);
            return false;
        }
    return true;
}

struct check {
    const char *system;
    struct variant *v;
    const struct ct_program *p;
    const struct ct_tape *tape;
    double *input, *want; // of NLANE lanes
    double *in, *out, *expected;
};

static bool check_lanes(struct check *c, const char *who, const struct ct_native *native,
                        size_t lanes)
{
    const size_t nwork = native ? ct_native_work(native) : lanes * ct_tape_work(c->tape);
    double *work = CT_NEWN(c->v->arena, double, nwork + 1);
    bool ok = true;
    for (size_t first = 0; first < NLANE; first += lanes) {
        take_lanes(c->in, c->input, c->v->m->ninput, first, lanes);
        take_lanes(c->expected, c->want, c->p->nout, first, lanes);
        if (native) {
            ct_native_prepare(native, c->in, work);
            ct_native_eval(native, c->in, c->out, work);
        } else {
            ct_tape_prepare_lanes(c->tape, (int)lanes, c->in, work);
            ct_tape_eval_lanes(c->tape, (int)lanes, c->in, c->out, work);
        }
        ok &= same_bits(c->system, who, c->out, c->expected, c->p->nout, lanes);
    }
    return ok;
}

static void evaluate_by_one(struct check *c)
{
    double *work = CT_NEWN(c->v->arena, double, ct_tape_work(c->tape) + 1);
    for (size_t i = 0; i < NLANE; i++) {
        take_lanes(c->in, c->input, c->v->m->ninput, i, 1);
        ct_tape_prepare(c->tape, c->in, work);
        ct_tape_eval(c->tape, c->in, c->out, work);
        for (size_t k = 0; k < c->p->nout; k++)
            c->want[NLANE * k + i] = c->out[k];
    }
}

// ---- compiled C ---------------------------------------------------------------------------------

typedef void (*evaluate_fn)(const double *in, double *out);

static bool check_compiled(struct check *c, evaluate_fn evaluate, size_t lanes)
{
    bool ok = true;
    for (size_t i = 0; i < NLANE; i += lanes) {
        take_lanes(c->in, c->input, c->v->m->ninput, i, lanes);
        take_lanes(c->expected, c->want, c->p->nout, i, lanes);
        evaluate(c->in, c->out);
        ok &= same_bits(c->system, "C", c->out, c->expected, c->p->nout, lanes);
    }
    return ok;
}

static bool check_c(struct check *c, unsigned lanes)
{
    char folder[] = "/tmp/ct_backends_XXXXXX", command[256], path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/e.c", folder);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    if (ct_listing_has_angles(c->p->listing))
        fputs(own_sincos, f);
    const struct ct_c_options o = {.lanes = lanes};
    fputs(ct_c_listing(c->v->arena, c->p->listing, &o), f);
    fclose(f);
    snprintf(command, sizeof command,
             "cc -std=c99 -Wall -Wextra -Wpedantic -Werror -O0 -ffp-contract=off -shared -fPIC "
             "-o %s/e.so %s -lm",
             folder, path);
    assert_int_equal(system(command), 0);
    snprintf(path, sizeof path, "%s/e.so", folder);
    void *handle = dlopen(path, RTLD_NOW), *symbol;
    assert_non_null(handle);
    assert_non_null(symbol = dlsym(handle, "evaluate"));
    if (ct_listing_has_angles(c->p->listing))
        own_sincos_set(handle);
    evaluate_fn evaluate;
    memcpy(&evaluate, &symbol, sizeof symbol); // C has no cast from an object to a function
    const bool ok = check_compiled(c, evaluate, lanes);
    dlclose(handle);
    unlink(path);
    snprintf(path, sizeof path, "%s/e.c", folder);
    unlink(path);
    rmdir(folder);
    return ok;
}

// ---- all systems --------------------------------------------------------------------------------

static bool check_program(const char *system, struct variant *v, const struct ct_program *p,
                          bool with_c, unsigned lanes_of_c)
{
    struct ct_arena *a = v->arena;
    struct check c = {.system = system, .v = v, .p = p, .input = random_inputs(v)};
    c.tape = ct_tape_create(a, p->listing);
    c.want = CT_NEWN(a, double, NLANE * p->nout + 1);
    c.in = CT_NEWN(a, double, NLANE * v->m->ninput);
    c.out = CT_NEWN(a, double, NLANE * p->nout + 1);
    c.expected = CT_NEWN(a, double, NLANE * p->nout + 1);
    if (!p->nout)
        return true;
    evaluate_by_one(&c);
    bool ok = check_lanes(&c, "tape x4", NULL, 4);
    ok &= check_lanes(&c, "tape x8", NULL, 8);
    static const struct {
        const char *name;
        int lanes;
    } all[] = {{"native", 1}, {"native x4", 4}, {"native x8", 8}};
    for (size_t i = 0; i < COUNT(all); i++) {
        const struct ct_native *native = ct_native_create(a, p->listing, all[i].lanes);
        ok &= !native || check_lanes(&c, all[i].name, native, (size_t)all[i].lanes);
    }
    return (!with_c || check_c(&c, lanes_of_c)) && ok;
}

static void shipped_systems_have_the_same_bits(void **unused)
{
    (void)unused;
    chance_start();
    const bool has_compiler = system("cc --version >/dev/null 2>&1") == 0;
    bool ok = true;
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        system_open_file(&s, shipped[i]);
        const struct ct_formulate_options *const all[] = {&by_joints, &by_bodies};
        for (size_t k = 0; k < COUNT(all); k++) {
            struct variant v;
            variant_open(&s, all[k], &v);
            static const unsigned lanes[]
                = {1, 4, 8}; // of compiled C, in turn: compiling takes long
            const bool with_c = has_compiler && k == 0;
            ok &= check_program(s.name, &v, &v.m->motion, with_c, lanes[i % 3]);
            ok &= check_program(s.name, &v, &v.m->constraint, with_c, lanes[(i + 1) % 3]);
            variant_close(&v);
        }
        system_close(&s);
    }
    assert_true(ok);
}

// Accelerations are computed from the same numbers, whatever evaluates them.
static void choice_of_back_end_changes_no_bit(void **unused)
{
    (void)unused;
    struct system s;
    struct variant v;
    system_open_file(&s, "systems/stewart/model.yaml");
    variant_open(&s, &by_joints, &v);
    variant_set(&v, &s.start, 0);
    assert_true(variant_solve(&v));
    double *before = CT_NEWN(v.arena, double, v.m->nu);
    memcpy(before, v.s->a, v.m->nu * sizeof *before);
    const bool has_native = ct_native_is_available(1);
    assert_string_equal(v.m->backend, has_native ? "native" : "tape");
    assert_true(ct_evaluator_use(v.arena, v.m, CT_BACKEND_TAPE));
    assert_string_equal(v.m->backend, "tape");
    assert_true(variant_solve(&v));
    assert_memory_equal(before, v.s->a, v.m->nu * sizeof *before);
    assert_true(ct_evaluator_use(v.arena, v.m, CT_BACKEND_NATIVE) == has_native);
    assert_true(variant_solve(&v));
    assert_memory_equal(before, v.s->a, v.m->nu * sizeof *before);
    variant_close(&v);
    system_close(&s);
}

// Long programs of open systems: native code fuses products with sums and so rounds less often than
// the tape.
static bool check_fused(const char *system, struct variant *v, bool *has_fused)
{
    const struct ct_program *p = &v->m->solved;
    const size_t nu = v->m->nu;
    const struct ct_native *native = ct_native_create(v->arena, p->listing, 1);
    if (!native)
        return true;
    const struct ct_tape *tape = ct_tape_create(v->arena, p->listing);
    double *work = CT_NEWN(v->arena, double, ct_native_work(native) + ct_tape_work(tape) + 1),
           *fused = CT_NEWN(v->arena, double, p->nout),
           *plain = CT_NEWN(v->arena, double, p->nout), *input = random_inputs(v),
           *one = CT_NEWN(v->arena, double, v->m->ninput);
    for (size_t i = 0; i < NLANE; i++) {
        double most = 0, off = 0;
        take_lanes(one, input, v->m->ninput, i, 1);
        ct_native_prepare(native, one, work);
        ct_native_eval(native, one, fused, work);
        ct_tape_prepare(tape, one, work);
        ct_tape_eval(tape, one, plain, work);
        for (size_t k = 0; k < nu; k++) {
            most = fmax(most, fabs(plain[k]));
            off = fmax(off, fabs(fused[k] - plain[k]));
        }
        *has_fused |= off > 0;
        if (!(off <= 1e-13 * most)) {
            print_error("%s: fused %.2g of the largest acceleration\n", system, off / most);
            return false;
        }
    }
    return true;
}

static void fused_operations_change_roundings_only(void **unused)
{
    static const struct ct_formulate_options solved
        = {.tree = CT_TREE_AUTO, .with_outputs = true, .with_solution = true};
    static const char *const open_system[]
        = {"systems/puma560/model.yaml", "systems/chain40/model.yaml",
           "systems/double_pendulum/model.yaml", "systems/cart_pole/model.yaml"};
    bool ok = true, has_fused = false;
    (void)unused;
    chance_start();
    for (size_t i = 0; i < COUNT(open_system); i++) {
        struct system s;
        struct variant v;
        system_open_file(&s, open_system[i]);
        variant_open(&s, &solved, &v);
        assert_true(v.m->solved.nout > 0);
        ok &= check_fused(s.name, &v, &has_fused);
        variant_close(&v);
        system_close(&s);
    }
    assert_true(ok);
    assert_true(has_fused
                || !ct_native_is_available(4)); // processors with AVX2 have fused operations
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_systems_have_the_same_bits),
        cmocka_unit_test(choice_of_back_end_changes_no_bit),
        cmocka_unit_test(fused_operations_change_roundings_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Generated C: exact text of a small function, bits of the tape from a compiled one.
#include "codegen/c.h"
#include "expr/tape.h"
#include "random_ex.h"
#include "tests/own_sincos.h"

#include <unistd.h>

static const double table_x[] = {-3, -1, 0, 1.5, 3}, table_y[] = {1, 2, 0, -1, 4},
                    table_m[] = {0.5, 0.1, -1, 0, 2};
static const struct ct_table tables[] = {{.n = 5, .x = table_x, .y = table_y},
                                         {.n = 5, .x = table_x, .y = table_y, .m = table_m}};

static const char *function_of(struct ct_arena *a, const struct ct_exs *x, const ct_ex *out,
                               size_t nout, const ct_ex *in, const size_t *slot, size_t nin,
                               const struct ct_c_options *options)
{
    return ct_c_listing(a, ct_listing_create(a, x, out, nout, in, slot, nin, CT_FUSE_NO),
                        options);
}

static void small_function_reads_well(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    ct_ex m = ct_ex_sym(&x, CT_SYM_PARAM, "m", 0), q = ct_ex_sym(&x, CT_SYM_Q, "crank.q", 0);
    ct_ex s = ct_ex_fun(&x, CT_OP_SIN, q);
    ct_ex_label(&x, s, "tip.x");
    const ct_ex out[] = {ct_ex_sub(&x, ct_ex_mul(&x, m, s), ct_ex_const(&x, 0.5)), m, s};
    const ct_ex in[] = {m, q};
    const size_t slot[] = {3, 0};
    const struct ct_c_options o = {.name = "motion", .title = "crank"};
    assert_string_equal(
        function_of(a, &x, out, 3, in, slot, 2, &o),
        "/* crank: 3 operations. Compile with -ffp-contract=off to keep the bits. */\n"
        "#include <math.h>\n"
        "\n"
        "void motion(const double *in, double *out);\n"
        "\n"
        "void motion(const double *in, double *out)\n"
        "{\n"
        "    (void)in;\n"
        "    (void)out;\n"
        "    const double i3_m = in[3];\n"
        "    const double i0_crank_q = in[0];\n"
        "    const double t0 = sin(i0_crank_q); /* tip.x */\n"
        "    const double t2 = (i3_m * t0) - 0.5;\n"
        "    out[2] = t0;\n"
        "    out[0] = t2;\n"
        "    out[1] = in[3];\n"
        "}\n");
    ct_arena_destroy(a);
}

// ---- compiled ---------------------------------------------------------------------------------

typedef void (*evaluate_fn)(const double *in, double *out);

struct object {
    char folder[64], source[96], object[96];
    void *handle;
    evaluate_fn evaluate;
};

static void write_file(const char *path, const char *before, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(fputs(before, f) >= 0);
    assert_int_equal(fwrite(text, 1, strlen(text), f), strlen(text));
    assert_int_equal(fclose(f), 0);
}

static void object_open(struct object *o, const char *text)
{
    char command[512];
    strcpy(o->folder, "/tmp/ct_test_c_XXXXXX");
    assert_non_null(mkdtemp(o->folder));
    snprintf(o->source, sizeof o->source, "%s/e.c", o->folder);
    snprintf(o->object, sizeof o->object, "%s/e.so", o->folder);
    write_file(o->source, own_sincos, text);
    snprintf(command, sizeof command,
             "cc -std=c99 -Wall -Wextra -Wpedantic -Werror -O1 -ffp-contract=off -shared -fPIC "
             "-o %s %s -lm",
             o->object, o->source);
    assert_int_equal(system(command), 0);
    o->handle = dlopen(o->object, RTLD_NOW);
    assert_non_null(o->handle);
    own_sincos_set(o->handle);
    void *symbol = dlsym(o->handle, "evaluate");
    assert_non_null(symbol);
    memcpy(&o->evaluate, &symbol, sizeof symbol); // C has no cast from an object to a function
}

static void object_close(struct object *o)
{
    dlclose(o->handle);
    unlink(o->object);
    unlink(o->source);
    rmdir(o->folder);
}

static bool has_compiler(void)
{
    return system("cc --version >/dev/null 2>&1") == 0;
}

enum { NIN = 8, NOUT = 40, MOST_LANES = 8 };

// Random inputs in all lanes; each lane against the tape.
static void compare_round(struct random *r, const struct object *object, struct ct_tape *t,
                          double *work, unsigned lanes)
{
    double in[MOST_LANES * NIN], got[MOST_LANES * NOUT], one[NIN], want[NOUT];
    for (size_t k = 0; k < lanes * NIN; k++)
        in[k] = random_double(r);
    object->evaluate(in, got);
    for (size_t lane = 0; lane < lanes; lane++) {
        for (size_t k = 0; k < NIN; k++)
            one[k] = in[lanes * k + lane];
        ct_tape_prepare(t, one, work);
        ct_tape_eval(t, one, want, work);
        for (size_t k = 0; k < NOUT; k++) {
            const double mine = got[lanes * k + lane];
            if (memcmp(&mine, &want[k], sizeof mine) && !(mine != mine && want[k] != want[k]))
                fail_msg("output %zu: C %.17g, tape %.17g", k, mine, want[k]);
        }
    }
}

static void compare(struct random *r, size_t n, size_t split, unsigned lanes)
{
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    x.table = tables;
    x.ntable = COUNT(tables);
    ct_ex sym[NIN], *e = CT_NEWN(a, ct_ex, n + NIN), out[NOUT];
    size_t slot[NIN];
    for (size_t k = 0; k < 8; k++) {
        sym[k] = e[k] = ct_ex_sym(&x, k % 2 ? CT_SYM_Q : CT_SYM_PARAM, "gamma", (uint32_t)k);
        slot[k] = 7 - k;
    }
    for (size_t k = 8; k < n + 8; k++)
        e[k] = random_node(r, &x, e, k);
    for (size_t k = 0; k < 40; k++)
        out[k] = k < 30 ? e[n + 8 - 1 - random_below(r, n)] : e[random_below(r, 12)];
    const struct ct_c_options o = {.split = split, .lanes = lanes};
    struct object object;
    object_open(&object, function_of(a, &x, out, 40, sym, slot, 8, &o));
    struct ct_tape *t = ct_tape_compile(a, &x, out, 40, sym, slot, 8);
    double *work = CT_NEWN(a, double, ct_tape_work(t));
    for (int round = 0; round < 20; round++)
        compare_round(r, &object, t, work, lanes);
    object_close(&object);
    ct_arena_destroy(a);
}

static void compiled_function_has_the_bits_of_the_tape(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    if (!has_compiler())
        skip();
    compare(&r, 40, 0, 1);
    compare(&r, 500, 0, 4);
    compare(&r, 500, 7, 1); // many parts
    compare(&r, 500, 100, 8);
    compare(&r, 3000, 0, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_function_reads_well),
        cmocka_unit_test(compiled_function_has_the_bits_of_the_tape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

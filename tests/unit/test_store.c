// The store of expressions finds every node again, however its operands lie.
#include "expr/ex.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { NSYMBOL = 40, NCONSTANT = 400 };

struct fixture {
    struct ct_arena *arena;
    struct ct_exs x;
    ct_ex s[NSYMBOL];
};

static void start(struct fixture *f)
{
    f->arena = ct_arena_create();
    ct_exs_init(&f->x, f->arena);
    for (uint32_t i = 0; i < NSYMBOL; i++)
        f->s[i] = ct_ex_sym(&f->x, CT_SYM_Q, "q", i);
}

// Node number k of many that have the newest symbol as their newest operand.
static ct_ex node_of(struct fixture *f, int k)
{
    const ct_ex last = f->s[NSYMBOL - 1];
    if (k < NSYMBOL)
        return ct_ex_add(&f->x, f->s[k], last);
    if (k < 2 * NSYMBOL)
        return ct_ex_div(&f->x, f->s[k - NSYMBOL], last);
    return ct_ex_fun2(&f->x, CT_OP_LT, f->s[k - 2 * NSYMBOL], last);
}

static void nodes_of_one_newest_operand_are_found_again(void **unused)
{
    struct fixture f;
    uint32_t id[3 * NSYMBOL - 1];
    (void)unused;
    start(&f);
    for (int k = 0; k < (int)COUNT(id); k++)
        id[k] = node_of(&f, k).id;
    const size_t n = f.x.nnode;
    for (int k = (int)COUNT(id); k-- > 0;)
        assert_int_equal(node_of(&f, k).id, id[k]);
    assert_int_equal(f.x.nnode, n);
    for (size_t i = 0; i < COUNT(id); i++)
        for (size_t k = 0; k < i; k++)
            assert_int_not_equal(id[i], id[k]);
    ct_arena_destroy(f.arena);
}

static void constants_are_found_again_as_the_store_grows(void **unused)
{
    struct fixture f;
    uint32_t id[NCONSTANT];
    (void)unused;
    start(&f);
    for (int i = 0; i < NCONSTANT; i++)
        id[i] = ct_ex_const(&f.x, 0.1 * i).id;
    for (int i = 0; i < NCONSTANT; i++) {
        double v = -1;
        assert_int_equal(ct_ex_const(&f.x, 0.1 * i).id, id[i]);
        assert_true(ct_ex_is_const(&f.x, (ct_ex){id[i]}, &v) && v == 0.1 * i);
    }
    assert_int_equal(ct_ex_const(&f.x, -0.0).id, 0);
    ct_arena_destroy(f.arena);
}

static void a_copy_finds_what_the_original_has(void **unused)
{
    struct fixture f;
    uint32_t id[3 * NSYMBOL - 1];
    (void)unused;
    start(&f);
    for (int k = 0; k < (int)COUNT(id); k++)
        id[k] = node_of(&f, k).id;
    struct ct_exs *copy = ct_exs_clone(f.arena, &f.x);
    const size_t n = copy->nnode;
    const struct ct_exs original = f.x;
    f.x = *copy;
    for (int k = 0; k < (int)COUNT(id); k++)
        assert_int_equal(node_of(&f, k).id, id[k]);
    assert_int_equal(f.x.nnode, n);
    const ct_ex made = ct_ex_mul(&f.x, (ct_ex){id[0]}, (ct_ex){id[1]});
    assert_int_equal(made.id, n); // new in the copy, and unknown to the original
    assert_int_equal(original.nnode, n);
    ct_arena_destroy(f.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_of_one_newest_operand_are_found_again),
        cmocka_unit_test(constants_are_found_again_as_the_store_grows),
        cmocka_unit_test(a_copy_finds_what_the_original_has),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

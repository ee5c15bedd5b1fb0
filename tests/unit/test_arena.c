// Arenas and the guard: alignment, zeroing, growth, and the way out when memory ends.
#include "base/arena.h"
#include "base/guard.h"
#include "tests/check.h"

#include <stdbool.h>
#include <string.h>

static int create(void **state)
{
    *state = ct_arena_create();
    return *state ? 0 : -1;
}

static int destroy(void **state)
{
    ct_guard_fail_after(0);
    ct_arena_destroy(*state);
    return 0;
}

static void allocations_are_aligned_and_zeroed(void **state)
{
    struct ct_arena *a = *state;
    static const unsigned char zero[5000];
    for (size_t size = 0; size < 5000; size += 1 + size / 3) { // beyond the first chunk
        unsigned char *p = ct_arena_alloc(a, size);
        assert_int_equal((uintptr_t)p % (size < 256 ? 16 : 64), 0); // a line of the caches
        assert_memory_equal(p, zero, size);
        memset(p, 0xff, size);
    }
}

static void allocations_do_not_overlap_or_move(void **state)
{
    enum { N = 3000 };
    struct ct_arena *a = *state;
    int *p[N];
    for (int i = 0; i < N; i++) {
        p[i] = CT_NEWN(a, int, 1 + i % 7);
        for (int k = 0; k <= i % 7; k++)
            p[i][k] = i;
    }
    for (int i = 0; i < N; i++)
        for (int k = 0; k <= i % 7; k++)
            assert_int_equal(p[i][k], i);
}

static void a_block_larger_than_any_chunk_is_given(void **state)
{
    const size_t size = (size_t)9 << 20;
    char *p = ct_arena_alloc(*state, size);
    p[0] = p[size - 1] = 1;
    assert_true(ct_arena_used(*state) >= size);
}

// Chunks of all sizes, small and large pages, and what is used again after another arena has gone.
static void many_megabytes_are_zeroed_and_stay(void **state)
{
    enum { N = 300, SIZE = 100000 };
    static const unsigned char zero[SIZE];
    (void)state;
    for (int round = 0; round < 2; round++) {
        struct ct_arena *a = ct_arena_create();
        unsigned char *p[N];
        assert_non_null(a);
        for (int i = 0; i < N; i++) {
            const size_t size = (size_t)(SIZE >> i % 12);
            p[i] = ct_arena_alloc(a, size);
            assert_memory_equal(p[i], zero, size);
            memset(p[i], i % 255 + 1, size);
        }
        for (int i = 0; i < N; i++)
            assert_true(p[i][0] == i % 255 + 1 && p[i][(SIZE >> i % 12) - 1] == i % 255 + 1);
        ct_arena_destroy(a);
    }
}

static void strings_are_copied_whole(void **state)
{
    struct ct_arena *a = *state;
    char text[] = "crank";
    const char *all = ct_arena_strdup(a, text), *part = ct_arena_strndup(a, text, 2);
    const char *made = ct_arena_printf(a, "%s.%d", text, 12),
               *joined = ct_arena_printf(a, "%s of %s:%s", text, "a-to-b", ""),
               *share = ct_arena_printf(a, "%s: 5 %%", text);
    text[0] = 'X';
    assert_string_equal(joined, "crank of a-to-b:");
    assert_string_equal(share, "crank: 5 %");
    assert_string_equal(all, "crank");
    assert_string_equal(part, "cr");
    assert_string_equal(made, "crank.12");
}

static void a_pushed_array_keeps_its_elements(void **state)
{
    struct ct_arena *a = *state;
    int *v = NULL;
    size_t n = 0, cap = 0;
    for (int i = 0; i < 1000; i++)
        CT_PUSH(a, v, n, cap, 3 * i);
    assert_int_equal(n, 1000);
    assert_true(cap >= n);
    for (int i = 0; i < 1000; i++)
        assert_int_equal(v[i], 3 * i);
}

// Blocks of arrays that have moved are freed: only those below 256 KiB stay, in ordinary chunks.
static void a_large_pushed_array_leaves_little_behind(void **state)
{
    enum { N = 1 << 18, LEFT = 1 << 18 };
    struct ct_arena *a = *state;
    for (int round = 0; round < 3; round++) {
        int *v = NULL;
        size_t n = 0, cap = 0;
        for (int i = 0; i < N; i++)
            CT_PUSH(a, v, n, cap, 3 * i);
        assert_in_range(ct_arena_used(a), cap * sizeof *v, cap * sizeof *v + LEFT);
        for (int i = 0; i < N; i++)
            assert_int_equal(v[i], 3 * i);
        for (size_t i = n; i < cap; i++)
            assert_int_equal(v[i], 0);
        ct_arena_clear(a);
    }
}

static void a_shared_array_is_copied(void **state)
{
    for (size_t n = 1; n <= (size_t)1 << 17; n <<= 17) {
        struct ct_arena *a = *state;
        int *v = NULL;
        size_t nv = 0, cap = 0;
        while (nv < n)
            CT_PUSH(a, v, nv, cap, 1);
        int *copy = v;
        size_t ncopy = nv, copy_cap = 0;
        CT_PUSH(a, copy, ncopy, copy_cap, 2);
        assert_ptr_not_equal(copy, v);
        assert_true(copy_cap >= ncopy && copy[n] == 2);
        for (size_t i = 0; i < n; i++)
            assert_true(v[i] == 1 && copy[i] == 1);
    }
}

static void count(void *n)
{
    ++*(int *)n;
}

// What a merged arena holds stays, and what is to be done at its end is done once, at the end of
// the other.
static void merged_arenas_end_together(void **state)
{
    static const size_t size[] = {0, 100, 10000}; // of what is in the one, and in the other
    for (size_t i = 0; i < COUNT(size); i++)
        for (size_t k = 0; k < COUNT(size); k++) {
            int n = 0;
            struct ct_arena *into = ct_arena_create(), *from = ct_arena_create_under(into);
            char *a = ct_arena_alloc(into, size[i] + 1), *b = ct_arena_alloc(from, size[k] + 1);
            if (size[i])
                ct_arena_on_destroy(into, count, &n);
            if (size[k])
                ct_arena_on_destroy(from, count, &n);
            struct ct_arena *under = ct_arena_create_under(from);
            char *c = ct_arena_strdup(under, "deep");
            memset(a, 1, size[i] + 1);
            memset(b, 2, size[k] + 1);
            const size_t used = ct_arena_used(into) + ct_arena_used(from);
            ct_arena_merge(into, from);
            assert_int_equal(ct_arena_used(into), used);
            memset(ct_arena_alloc(into, 5000), 3, 5000);
            assert_true(a[size[i]] == 1 && b[0] == 2 && b[size[k]] == 2);
            assert_string_equal(c, "deep");
            ct_arena_destroy(into);
            assert_int_equal(n, (size[i] > 0) + (size[k] > 0));
        }
    struct ct_arena *empty = ct_arena_create();
    ct_arena_merge(*state, empty);
    ct_arena_merge(empty = ct_arena_create(), ct_arena_create());
    ct_arena_destroy(empty);
}

enum { NREQUEST = 40 };

// Many small ones and some that take chunks of pages. Each is zero when it comes and is not when
// the next is asked for.
static void request(struct ct_arena *a, size_t more, unsigned char **p)
{
    for (size_t i = 0; i < NREQUEST; i++) {
        const size_t size = (i % 10 == 9 ? (size_t)300000 : 700 * i) + more;
        p[i] = ct_arena_alloc(a, size);
        for (size_t k = 0; k < size; k++)
            assert_int_equal(p[i][k], 0);
        memset(p[i], 0xff, size);
    }
}

static void a_cleared_arena_gives_zeros_at_the_same_places(void **state)
{
    struct ct_arena *a = *state;
    unsigned char *first[NREQUEST], *again[NREQUEST];
    request(a, 0, first);
    const size_t used = ct_arena_used(a);
    for (int round = 0; round < 3; round++) {
        ct_arena_clear(a);
        assert_int_equal(ct_arena_used(a), 0);
        ct_guard_fail_after(1); // the system is not asked
        request(a, 0, again);
        ct_guard_fail_after(0);
        assert_memory_equal(again, first, sizeof first);
        assert_int_equal(ct_arena_used(a), used);
    }
}

static void a_cleared_arena_gives_zeros_to_other_requests(void **state)
{
    static const size_t more[] = {0, 5000, 16, 100000, 48, 0};
    unsigned char *p[NREQUEST];
    for (size_t i = 0; i < COUNT(more); i++) {
        request(*state, more[i], p);
        ct_arena_clear(*state);
    }
}

static void clearing_ends_what_is_in_it_once(void **state)
{
    struct ct_arena *a = *state;
    int n = 0;
    ct_arena_clear(a); // nothing is in it
    ct_arena_on_destroy(a, count, &n);
    ct_arena_on_destroy(ct_arena_create_under(a), count, &n);
    ct_arena_clear(a);
    assert_int_equal(n, 2);
    ct_arena_clear(a);
    assert_int_equal(n, 2);
    struct ct_arena *from = ct_arena_create_under(a);
    request(from, 0, (unsigned char *[NREQUEST]){0});
    ct_arena_clear(from);
    ct_arena_merge(a, from); // with chunks to spare
}

static void destroying_nothing_is_allowed(void **state)
{
    (void)state;
    ct_arena_destroy(NULL);
}

// Runs work(a) under a guard; true if it came back through the guard.
static bool runs_out(struct ct_arena *a, void (*work)(struct ct_arena *a))
{
    struct ct_guard g;
    ct_guard_push(&g);
    if (setjmp(g.env)) {
        ct_guard_pop(&g);
        return true;
    }
    work(a);
    ct_guard_pop(&g);
    return false;
}

static void ask_for_two_chunks(struct ct_arena *a)
{
    ct_arena_alloc(a, 4096);
    ct_arena_alloc(a, 8192);
}

static void ask_for_too_much(struct ct_arena *a)
{
    ct_arena_alloc(a, SIZE_MAX - 8);
}

static void ask_for_an_overflowing_product(struct ct_arena *a)
{
    ct_arena_calloc(a, SIZE_MAX / 4, 8);
}

static void the_nth_refusal_reaches_the_guard(void **state)
{
    for (long n = 1; n <= 2; n++) {
        ct_guard_fail_after(n);
        struct ct_arena *a = *state;
        assert_true(runs_out(a, ask_for_two_chunks));
        destroy(state);
        create(state);
    }
    ct_guard_fail_after(3);
    assert_false(runs_out(*state, ask_for_two_chunks));
}

static void after_a_refusal_the_arena_is_usable(void **state)
{
    struct ct_arena *a = *state;
    ct_guard_fail_after(1);
    assert_true(runs_out(a, ask_for_two_chunks));
    assert_false(runs_out(a, ask_for_two_chunks));
    assert_string_equal(ct_arena_strdup(a, "still here"), "still here");
}

static void impossible_sizes_count_as_out_of_memory(void **state)
{
    assert_true(runs_out(*state, ask_for_too_much));
    assert_true(runs_out(*state, ask_for_an_overflowing_product));
}

static void creation_reports_a_refusal_by_null(void **state)
{
    (void)state;
    ct_guard_fail_after(1);
    assert_null(ct_arena_create());
}

static void refuse_inside(struct ct_arena *a)
{
    assert_true(runs_out(a, ask_for_too_much));
    ct_arena_alloc(a, 16);
}

static void guards_nest(void **state)
{
    assert_false(runs_out(*state, refuse_inside)); // the inner guard catches its own
    assert_true(runs_out(*state, ask_for_too_much));
}

struct note {
    char **p, letter;
};

static void note_letter(void *data)
{
    struct note *n = data;
    *(*n->p)++ = n->letter;
}

static void endings_run_once_the_latest_first(void **state)
{
    (void)state;
    char text[4] = "", *p = text;
    struct ct_arena *a = ct_arena_create();
    // NOLINTNEXTLINE(bugprone-too-small-loop-variable): the bound fits a char
    for (char c = 'a'; c <= 'c'; c++) {
        struct note *n = CT_NEW(a, struct note); // still there when it is used
        *n = (struct note){&p, c};
        ct_arena_on_destroy(a, note_letter, n);
    }
    assert_string_equal(text, "");
    ct_arena_destroy(a);
    assert_string_equal(text, "cba");
}

int main(void)
{
#define CASE(f) cmocka_unit_test_setup_teardown(f, create, destroy)
    const struct CMUnitTest tests[] = {
        CASE(allocations_are_aligned_and_zeroed),
        CASE(allocations_do_not_overlap_or_move),
        CASE(a_block_larger_than_any_chunk_is_given),
        CASE(many_megabytes_are_zeroed_and_stay),
        CASE(strings_are_copied_whole),
        CASE(a_pushed_array_keeps_its_elements),
        CASE(a_large_pushed_array_leaves_little_behind),
        CASE(a_shared_array_is_copied),
        CASE(merged_arenas_end_together),
        CASE(a_cleared_arena_gives_zeros_at_the_same_places),
        CASE(a_cleared_arena_gives_zeros_to_other_requests),
        CASE(clearing_ends_what_is_in_it_once),
        CASE(destroying_nothing_is_allowed),
        CASE(the_nth_refusal_reaches_the_guard),
        CASE(after_a_refusal_the_arena_is_usable),
        CASE(impossible_sizes_count_as_out_of_memory),
        CASE(creation_reports_a_refusal_by_null),
        CASE(guards_nest),
        CASE(endings_run_once_the_latest_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

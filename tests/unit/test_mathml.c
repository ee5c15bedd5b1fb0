// MathML of LaTeX, to the letter, and text that would break a page.
#include "report/mathml.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// What a writer puts into a file; the caller frees it.
struct sink {
    char *text;
    size_t n;
    FILE *file;
};

static struct sink open_sink(void)
{
    struct sink s = {0};
    s.file = tmpfile();
    assert_non_null(s.file);
    return s;
}

static void check(struct sink *s, const char *want)
{
    const long n = ftell(s->file);
    char *text = calloc((size_t)n + 1, 1);
    rewind(s->file);
    assert_int_equal(fread(text, 1, (size_t)n, s->file), n);
    assert_string_equal(text, want);
    free(text);
    fclose(s->file);
}

static void each_command_becomes_its_element(void **unused)
{
    (void)unused;
    static const char *const table[][2] = {
        {"m", "<mi>m</mi>"},
        {"3.5", "<mn>3.5</mn>"},
        {"m \\, l^{2}",
         "<mi>m</mi><mo rspace=\".17em\">\u2062</mo><msup><mi>l</mi><mn>2</mn></msup>"},
        {"\\frac{a + b}{2}",
         "<mfrac><mrow><mi>a</mi><mo form=\"infix\">+</mo><mi>b</mi></mrow><mn>2</mn></mfrac>"},
        {"-\\theta", "<mo form=\"prefix\">\u2212</mo><mi>\u03B8</mi>"},
        {"\\ddot{q}_{1,\\mathrm{crank}}",
         "<msub><mover accent=\"true\"><mi>q</mi><mo stretchy=\"false\">\u00A8</mo></mover>"
         "<mrow><mn>1</mn><mo>,</mo><mi>crank</mi></mrow></msub>"},
        {"\\cos^{2} q",
         "<msup><mi>cos</mi><mn>2</mn></msup><mo rspace=\".17em\">\u2061</mo><mi>q</mi>"},
        {"\\sin\\left(a\\right)",
         "<mi>sin</mi><mo rspace=\"0\">\u2061</mo><mrow><mo form=\"prefix\" "
         "stretchy=\"false\">(</mo>"
         "<mi>a</mi><mo form=\"postfix\" stretchy=\"false\">)</mo></mrow>"},
        {"\\left(\\left(a\\right)^{2}\\right)^{-1}",
         "<msup><mrow><mo form=\"prefix\" stretchy=\"false\">(</mo><msup><mrow><mo "
         "form=\"prefix\" "
         "stretchy=\"false\">(</mo><mi>a</mi><mo form=\"postfix\" "
         "stretchy=\"false\">)</mo></mrow>"
         "<mn>2</mn></msup><mo form=\"postfix\" stretchy=\"false\">)</mo></mrow>"
         "<mrow><mo form=\"prefix\">\u2212</mo><mn>1</mn></mrow></msup>"},
        {"\\boldsymbol{S}_{\\mathrm{rod}}^{T}",
         "<msubsup><mi class=\"vector\">S</mi><mi>rod</mi><mi>T</mi></msubsup>"},
        {"\\boldsymbol{\\omega}", "<mi class=\"vector\">\u03C9</mi>"},
        {"\\int_0^{\\xi} x",
         "<msubsup><mo>\u222B</mo><mn>0</mn><mi>\u03BE</mi></msubsup><mi>x</mi>"},
        {"2 \\cdot 10^{-5}", "<mn>2</mn><mo>\u22C5</mo><msup><mn>10</mn><mrow><mo "
                             "form=\"prefix\">\u2212</mo><mn>5</mn>"
                             "</mrow></msup>"},
        {"\\sqrt{x}", "<msqrt><mi>x</mi></msqrt>"},
        {"\\begin{cases} a & b \\neq 0 \\\\ c & \\text{otherwise} \\end{cases}",
         "<mrow><mo form=\"prefix\" "
         "stretchy=\"true\">{</mo><mtable><mtr><mtd><mi>a</mi></mtd><mtd>"
         "<mi>b</mi><mo>\u2260</mo><mn>0</mn></mtd></mtr><mtr><mtd><mi>c</mi></mtd><mtd>"
         "<mtext>otherwise</mtext></mtd></mtr></mtable></mrow>"},
        {"\\mathrm{big\\_end}", "<mi>big_end</mi>"},
        {"\\operatorname{Rot}(z, q)",
         "<mi>Rot</mi><mo rspace=\"0\">\u2061</mo><mo form=\"prefix\" stretchy=\"false\">(</mo>"
         "<mi>z</mi><mo>,</mo><mi>q</mi><mo form=\"postfix\" stretchy=\"false\">)</mo>"},
        {"f'", "<mi>f</mi><mo>\u2032</mo>"},
        {"a < b", "<mi>a</mi><mo>&lt;</mo><mi>b</mi>"},
        // a command that is not known, and what does not end
        {"\\foo", "<mi>foo</mi>"},
        {"\\frac{a}", "<mfrac><mi>a</mi><mrow></mrow></mfrac>"},
        {"\\left(a", "<mrow><mo form=\"prefix\" stretchy=\"false\">(</mo><mi>a</mi></mrow>"},
        {"a_", "<msub><mi>a</mi><mrow></mrow></msub>"},
        {"\\", "<mi mathvariant=\"normal\">\\</mi>"},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        struct sink s = open_sink();
        ct_mathml_row(s.file, table[i][0]);
        check(&s, table[i][1]);
    }
}

static void hostile_text_is_harmless(void **unused)
{
    (void)unused;
    static const char *const table[][2] = {
        {"</script>&\"'", "&lt;/script&gt;&amp;&quot;'"},
        {"a\u202Eb\u2067c\u200Fd", "a\uFFFDb\uFFFDc\uFFFDd"}, // direction of text
        {"a\x01"
         "b\xFF"
         "c\xC0\xAF"
         "d\xED\xA0\x80", // controls, no UTF-8, too long, a surrogate
         "a\uFFFDb\uFFFDc\uFFFD\uFFFDd\uFFFD"},
        {"a\nb\tc", "a\nb\tc"},
        {"\u03B8\u4E2D", "\u03B8\u4E2D"},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        struct sink s = open_sink();
        ct_html_text(s.file, table[i][0], SIZE_MAX);
        check(&s, table[i][1]);
    }
    struct sink s = open_sink();
    ct_html_text(s.file, "abc\u03B8", 4); // in the middle of a character
    check(&s, "abc\uFFFD");
}

static void terms_say_where_they_come_from(void **unused)
{
    (void)unused;
    const struct ct_mathml_term left[]
        = {{.latex = "a", .components = "crank \"rod"}, {.latex = " - b"}};
    const struct ct_mathml_term right[] = {{.latex = "c", .value = "1<2", .note = "two words"}};
    const struct ct_mathml_equation e
        = {.name = "main.u\"", .left = {left, 2}, .right = {right, 1}};
    struct sink s = open_sink();
    ct_mathml_equation(s.file, &e);
    check(&s,
          "<math class=\"equation\" display=\"block\" data-equation=\"main.u&quot;\">"
          "<mrow class=\"side\"><mrow class=\"term\" data-component=\"crank "
          "&quot;rod\"><mi>a</mi>"
          "</mrow><mrow class=\"term\"><mo form=\"infix\" lspace=\"0.22em\" rspace=\"0.22em\">"
          "\u2212</mo><mi>b</mi></mrow></mrow><mrow class=\"right\"><mo>=</mo>"
          "<mrow class=\"side\"><mrow class=\"term\"><mi>c</mi></mrow>"
          "<mtext class=\"value\">1&lt;2</mtext><mtext class=\"note\">two</mtext>"
          "<mtext class=\"note\">words</mtext></mrow></mrow></math>\n");
}

// A term wider than a phone is made of pieces: the second one begins with the sign in the
// parentheses.
static void wide_terms_break_in_parentheses(void **unused)
{
    (void)unused;
    const struct ct_mathml_term term = {
        .latex = "m \\, \\left(0.12345678901234 \\alpha + 0.12345678901234 \\beta\\right)^{2}"};
    const struct ct_mathml_equation e = {.left = {&term, 1}};
    struct sink s = open_sink();
    ct_mathml_equation(s.file, &e);
    check(&s,
          "<math class=\"equation\" display=\"block\"><mrow class=\"side\"><mrow class=\"term "
          "wide\">"
          "<mrow><mi>m</mi><mo rspace=\".17em\">\u2062</mo><mo form=\"prefix\" "
          "stretchy=\"false\">("
          "</mo><mn>0.12345678901234</mn></mrow><mrow><mi>\u03B1</mi></mrow><mrow><mo "
          "form=\"infix\">+</mo>"
          "<mn>0.12345678901234</mn></mrow><mrow><mi>\u03B2</mi><msup><mo form=\"postfix\" "
          "stretchy=\"false\">)</mo><mn>2</mn></msup></mrow></mrow></mrow></math>\n");
}

static void matrices_are_tables(void **unused)
{
    (void)unused;
    const char *const cell[] = {"", "a", "\\mathrm{row}", "."};
    struct sink s = open_sink();
    ct_mathml_matrix(s.file, cell, 2, 2, true);
    check(&s, "<div class=\"matrix\"><math><mtable>\n<mtr><mtd class=\"name\"></mtd><mtd "
              "class=\"name\">"
              "<mi>a</mi></mtd></mtr>\n<mtr><mtd "
              "class=\"name\"><mi>row</mi></mtd><mtd><mo>\u22C5</mo>"
              "</mtd></mtr>\n</mtable></math></div>\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_command_becomes_its_element),
        cmocka_unit_test(hostile_text_is_harmless),
        cmocka_unit_test(terms_say_where_they_come_from),
        cmocka_unit_test(wide_terms_break_in_parentheses),
        cmocka_unit_test(matrices_are_tables),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Characters of expressions and units. No locale.
#ifndef CT_EXPR_CHARACTER_H
#define CT_EXPR_CHARACTER_H

#include <stdbool.h>

static inline bool ct_is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static inline bool ct_is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static inline bool ct_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

#endif

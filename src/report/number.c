// See number.h.
#include "report/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *ct_number_format(char text[CT_NUMBER_SIZE], double v)
{
    if (isnan(v)) // printf shows the sign of a NaN, which differs between machines
        return strcpy(text, "nan");
    snprintf(text, CT_NUMBER_SIZE, "%.17g", v);
    if (isinf(v))
        return text;
    // The decimal point of a locale may be any character, of several bytes.
    char *point = text + strspn(text, "+-0123456789e");
    const size_t n = strcspn(point, "+-0123456789e");
    if (n) {
        *point = '.';
        memmove(point + 1, point + n, strlen(point + n) + 1);
    }
    return text;
}

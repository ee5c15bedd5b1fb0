// See number.h.
#include "report/number.h"

const char *ct_number_format(char text[CT_NUMBER_SIZE], double v)
{
    ct_decimal_format(text, v);
    return text;
}

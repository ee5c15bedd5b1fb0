// Numbers as text that reads back to the same bits, the same in every locale.
#ifndef CT_REPORT_NUMBER_H
#define CT_REPORT_NUMBER_H

#include "base/decimal.h"

enum { CT_NUMBER_SIZE = CT_DECIMAL_SIZE };

/// Write v with the fewest digits that read back (base/decimal.h) to text; what is not finite
/// becomes nan, inf or -inf. Returns text.
const char *ct_number_format(char text[CT_NUMBER_SIZE], double v);

#endif

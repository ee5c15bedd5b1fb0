// Numbers as text that reads back to the same bits, the same in every locale.
#ifndef CT_REPORT_NUMBER_H
#define CT_REPORT_NUMBER_H

enum { CT_NUMBER_SIZE = 32 };

/// Write v with 17 significant digits (%.17g) and a decimal point to text; what is not finite
/// becomes nan, inf or -inf. Returns text.
const char *ct_number_format(char text[CT_NUMBER_SIZE], double v);

#endif

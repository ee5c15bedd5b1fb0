// The header of KLU, for sparse.c and factors.c, which wrap it.
#ifndef CT_NUMERIC_KLU_INCLUDE_H
#define CT_NUMERIC_KLU_INCLUDE_H

#if CT_HAS_KLU
#if __has_include(<suitesparse/klu.h>)
#include <suitesparse/klu.h>
#else
#include <klu.h>
#endif
#endif

/// Threshold partial pivoting: a diagonal entry is the pivot if it is at least this part of the
/// largest one in its column. Definition: the usual choice, key duff2017; it bounds growth by 11 a
/// step.
#define CT_PIVOT_THRESHOLD 0.1

#endif

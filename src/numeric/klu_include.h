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

#endif

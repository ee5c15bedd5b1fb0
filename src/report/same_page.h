// Tests whether two parts of a page of text differ only by names.
//
//     t1 = 0.5*part2.v;  m_part2 = t1*b + a        t7 = 0.5*part3.v;  m_part3 = a + b*t7        the same, with part3 for part2
//
// A part becomes a hash. The name, the numbers of t1, t2, ... and the order of terms and
// factors do not matter; short names stand for their definitions. What always holds: equal
// hashes come from equal parts, except for a coincidence of 64 bits.
#ifndef CT_REPORT_SAME_PAGE_H
#define CT_REPORT_SAME_PAGE_H

#include "report/page.h"

#include <stdint.h>

/// Hash of the blocks of p from block `from` on, which are about `name`. Workspace in the arena
/// of the page.
uint64_t ct_page_meaning(const struct ct_page *p, size_t from, const char *name);

#endif

// Arrays for NumPy: a ZIP archive without compression that holds one .npy file for each array.
//
//     numpy.load("file.npz")["A"]
//
// Matrices are column-major in memory and in the file (fortran_order), names are texts of equal length.
// Source: NumPy enhancement proposal 1 (format 1.0); PKWARE APPNOTE 6.3 for ZIP.
#ifndef CT_REPORT_NPZ_H
#define CT_REPORT_NPZ_H

#include "report/outfile.h"

#include <stdint.h>

struct ct_npz {
    struct ct_arena *arena;
    struct ct_outfile file;
    struct ct_npz_entry {
        const char *name;
        uint32_t crc, size, offset;
    } * entry;
    size_t nentry, cap;
    uint32_t offset; // of what comes next
};

/// path: a file. Errors: E002.
bool ct_npz_open(struct ct_ctx *ctx, struct ct_npz *z, const char *path);
/// A (n x m, column-major) under a name.
void ct_npz_matrix(struct ct_npz *z, const char *name, const double *A, size_t n, size_t m);
void ct_npz_vector(struct ct_npz *z, const char *name, const double *v, size_t n);
/// Texts in UTF-8 as an array of strings.
void ct_npz_names(struct ct_npz *z, const char *name, const char *const *text, size_t n);
/// Complete the file under its own name. Errors: E002.
bool ct_npz_close(struct ct_ctx *ctx, struct ct_npz *z);

#endif

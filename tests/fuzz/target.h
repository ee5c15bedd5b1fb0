// A fuzz target in libFuzzer's form, so that the same file serves the replay and the search.
#ifndef CT_TESTS_FUZZ_TARGET_H
#define CT_TESTS_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

/// One input; aborts when something is wrong, else returns 0.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif

/* What newlib's printf needs on a target: the firmware example's semihosting as its output. */
#include "semihosting.h"

int _write(int file, const char *text, int size);

int _write(int file, const char *text, int size)
{
    (void)file;
    for (int k = 0; k < size; ++k) {
        const char one[2] = {text[k], '\0'};
        semihosting_write(one);
    }
    return size;
}

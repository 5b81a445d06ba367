/* The same drive and firmware on a computer: it writes what was seen in each sample in motion into a file.
 * cc -DLEARN_ON_A_COMPUTER -DECCENTRIC_REAL=float -I. -IEMITTED learn_on_a_computer.c learn.c EMITTED/c2_parallel*.c -lm */
#include "learn.h"
#include "semihosting.h"

#include <stdio.h>

static FILE *rows;

void semihosting_write(const char *text)
{
    fputs(text, stdout);
}

static void record(const learn_row *row)
{
    (void)fwrite(row, sizeof *row, 1, rows);
}

int main(int count, char **arguments)
{
    rows = (count == 2) ? fopen(arguments[1], "wb") : NULL;
    if (rows == NULL) {
        return 64;
    }
    const int failed = learn(record);
    return (fclose(rows) == 0) ? failed : 65;
}

/* Text and exit status for the debugger or emulator that the firmware runs in. */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

/** Write a text. */
void semihosting_write(const char *text);

/** End the run; QEMU exits with the status. */
void semihosting_exit(int status) __attribute__((noreturn));

#endif

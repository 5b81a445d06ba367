/* Forces the functions of float onto generated C that calls those of double. */
#include <math.h>
#define sqrt sqrtf
#define cos cosf
#define sin sinf
#define fabs fabsf
#define pow powf

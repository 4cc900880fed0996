/* A mass on a spring with dry friction, for the units of FMI 2.0 and 3.0. */
#include <math.h>
#include <string.h>
enum { FORCE, POSITION, SPEED, STIFFNESS, VISCOUS, COULOMB, MASS, CUBIC, COUNT };
typedef struct { double v[COUNT]; int substeps; } State;
static void begin(State *s) {
    memset(s, 0, sizeof *s);
    s->v[STIFFNESS] = 100; s->v[VISCOUS] = 0.5; s->v[MASS] = 1; s->substeps = 8;
}
static void step(State *s, double h, int steps) {
    double *v = s->v;
    for (int k = 0; k < steps; k++) {
        double dt = h / steps, x = v[POSITION];
        double f = v[FORCE] - v[STIFFNESS] * x - v[VISCOUS] * v[SPEED] - v[COULOMB] * tanh(v[SPEED] / 0.002) - v[CUBIC] * x * x * x;
        v[SPEED] += dt * f / v[MASS];
        v[POSITION] += dt * v[SPEED];
    }
}

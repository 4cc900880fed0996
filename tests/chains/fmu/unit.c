/* A mass on a spring with dry friction as an FMI 2.0 unit for co-simulation; no header of the standard is needed. */
#include <stdlib.h>
#include "mass.h"
typedef void *Unit;
typedef unsigned int Ref;
const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
Unit fmi2Instantiate(const char *n, int t, const char *g, const char *r, const void *f, int v, int l) {
    State *s = malloc(sizeof *s); if (s) begin(s); return s;
}
void fmi2FreeInstance(Unit u) { free(u); }
int fmi2SetDebugLogging(Unit u, int l, size_t n, const char *const c[]) { return 0; }
int fmi2SetupExperiment(Unit u, int td, double tol, double t0, int sd, double t1) { return 0; }
int fmi2EnterInitializationMode(Unit u) { return 0; }
int fmi2ExitInitializationMode(Unit u) { return 0; }
int fmi2Terminate(Unit u) { return 0; }
int fmi2Reset(Unit u) { begin(u); return 0; }
int fmi2GetReal(Unit u, const Ref r[], size_t n, double x[]) {
    for (size_t i = 0; i < n; i++) x[i] = ((State *)u)->v[r[i]];
    return 0;
}
int fmi2SetReal(Unit u, const Ref r[], size_t n, const double x[]) {
    for (size_t i = 0; i < n; i++) ((State *)u)->v[r[i]] = x[i];
    return 0;
}
int fmi2DoStep(Unit u, double t, double h, int keep) { step(u, h, 8); return 0; }
#define NONE(name) int name() { return 3; }
NONE(fmi2GetInteger) NONE(fmi2GetBoolean) NONE(fmi2GetString) NONE(fmi2SetInteger) NONE(fmi2SetBoolean) NONE(fmi2SetString)
NONE(fmi2GetFMUstate) NONE(fmi2SetFMUstate) NONE(fmi2FreeFMUstate) NONE(fmi2SerializedFMUstateSize) NONE(fmi2SerializeFMUstate)
NONE(fmi2DeSerializeFMUstate) NONE(fmi2GetDirectionalDerivative) NONE(fmi2SetRealInputDerivatives) NONE(fmi2GetRealOutputDerivatives)
NONE(fmi2CancelStep) NONE(fmi2GetStatus) NONE(fmi2GetRealStatus) NONE(fmi2GetIntegerStatus) NONE(fmi2GetBooleanStatus) NONE(fmi2GetStringStatus)

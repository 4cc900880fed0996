/* The mass of mass.h as an FMI 3.0 unit for co-simulation; no header of the standard is needed. Coulomb friction and the cubic
   spring are Float32, the number of steps within a communication step is Int32, and `masses` is an array of two. A unit
   that is asked for event mode, early return or intermediate updates refuses to be instantiated. */
#include <stdbool.h>
#include <stdlib.h>
#include "mass.h"
typedef void *Unit;
typedef unsigned int Ref;
enum { SUBSTEPS = COUNT, MASSES };
enum { OK, ERROR = 3 };
const char *fmi3GetVersion(void) { return "3.0"; }
Unit fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible, bool logging,
    bool event_mode, bool early_return, const Ref intermediate[], size_t n, void *environment, void *log, void *update) {
    State *s = event_mode || early_return || n || update ? NULL : malloc(sizeof *s);
    if (s) begin(s);
    return s;
}
void fmi3FreeInstance(Unit u) { free(u); }
int fmi3EnterInitializationMode(Unit u, bool td, double tol, double t0, bool sd, double t1) { return OK; }
int fmi3ExitInitializationMode(Unit u) { return OK; }
int fmi3Terminate(Unit u) { return OK; }
int fmi3Reset(Unit u) { begin(u); return OK; }
static int narrow(Ref r) { return r == COULOMB || r == CUBIC; }
int fmi3GetFloat64(Unit u, const Ref r[], size_t n, double x[], size_t count) {
    if (n != count) return ERROR;
    for (size_t i = 0; i < n; i++) if (r[i] >= COUNT || narrow(r[i])) return ERROR; else x[i] = ((State *)u)->v[r[i]];
    return OK;
}
int fmi3SetFloat64(Unit u, const Ref r[], size_t n, const double x[], size_t count) {
    if (n != count) return ERROR;
    for (size_t i = 0; i < n; i++) if (r[i] >= COUNT || narrow(r[i])) return ERROR; else ((State *)u)->v[r[i]] = x[i];
    return OK;
}
int fmi3GetFloat32(Unit u, const Ref r[], size_t n, float x[], size_t count) {
    for (size_t i = 0; i < n; i++) if (!narrow(r[i])) return ERROR; else x[i] = (float)((State *)u)->v[r[i]];
    return OK;
}
int fmi3SetFloat32(Unit u, const Ref r[], size_t n, const float x[], size_t count) {
    for (size_t i = 0; i < n; i++) if (!narrow(r[i])) return ERROR; else ((State *)u)->v[r[i]] = x[i];
    return OK;
}
int fmi3SetInt32(Unit u, const Ref r[], size_t n, const int x[], size_t count) {
    for (size_t i = 0; i < n; i++) if (r[i] != SUBSTEPS || x[i] < 1) return ERROR; else ((State *)u)->substeps = x[i];
    return OK;
}
int fmi3DoStep(Unit u, double t, double h, bool keep, bool *event, bool *terminate, bool *early, double *last) {
    *event = *terminate = *early = false;
    *last = t + h;
    step(u, h, ((State *)u)->substeps);
    return OK;
}
#define NONE(name) int name() { return ERROR; }
NONE(fmi3ActivateModelPartition) NONE(fmi3CompletedIntegratorStep) NONE(fmi3DeserializeFMUState)
NONE(fmi3EnterConfigurationMode) NONE(fmi3EnterContinuousTimeMode) NONE(fmi3EnterEventMode) NONE(fmi3EnterStepMode)
NONE(fmi3EvaluateDiscreteStates) NONE(fmi3ExitConfigurationMode) NONE(fmi3FreeFMUState) NONE(fmi3GetAdjointDerivative)
NONE(fmi3GetBinary) NONE(fmi3GetBoolean) NONE(fmi3GetClock) NONE(fmi3GetContinuousStateDerivatives)
NONE(fmi3GetContinuousStates) NONE(fmi3GetDirectionalDerivative) NONE(fmi3GetEventIndicators) NONE(fmi3GetFMUState)
NONE(fmi3GetInt16) NONE(fmi3GetInt32) NONE(fmi3GetInt64) NONE(fmi3GetInt8) NONE(fmi3GetIntervalDecimal)
NONE(fmi3GetIntervalFraction) NONE(fmi3GetNominalsOfContinuousStates) NONE(fmi3GetNumberOfContinuousStates)
NONE(fmi3GetNumberOfEventIndicators) NONE(fmi3GetNumberOfVariableDependencies) NONE(fmi3GetOutputDerivatives)
NONE(fmi3GetShiftDecimal) NONE(fmi3GetShiftFraction) NONE(fmi3GetString) NONE(fmi3GetUInt16) NONE(fmi3GetUInt32)
NONE(fmi3GetUInt64) NONE(fmi3GetUInt8) NONE(fmi3GetVariableDependencies) 
NONE(fmi3SerializeFMUState) NONE(fmi3SerializedFMUStateSize) NONE(fmi3SetBinary)
NONE(fmi3SetBoolean) NONE(fmi3SetClock) NONE(fmi3SetContinuousStates) NONE(fmi3SetDebugLogging) NONE(fmi3SetFMUState)
NONE(fmi3SetInt16) NONE(fmi3SetInt64) NONE(fmi3SetInt8) NONE(fmi3SetIntervalDecimal) NONE(fmi3SetIntervalFraction)
NONE(fmi3SetShiftDecimal) NONE(fmi3SetShiftFraction) NONE(fmi3SetString) NONE(fmi3SetTime) NONE(fmi3SetUInt16)
NONE(fmi3SetUInt32) NONE(fmi3SetUInt64) NONE(fmi3SetUInt8) NONE(fmi3UpdateDiscreteStates)
Unit fmi3InstantiateModelExchange() { return NULL; }
Unit fmi3InstantiateScheduledExecution() { return NULL; }

/* Functions of an FMU that the importers of the tests call. */

#include "lw_fmi3.h"

typedef fmi3Instance instance;
typedef const fmi3ValueReference references[];

extern fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
    fmi3InstanceEnvironment, fmi3LogMessageCallback);
extern fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
    fmi3Boolean, fmi3Boolean, references, size_t, fmi3InstanceEnvironment, fmi3LogMessageCallback,
    fmi3IntermediateUpdateCallback);
extern void fmi3FreeInstance(instance);
extern fmi3Status fmi3EnterInitializationMode(instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64);
extern fmi3Status fmi3ExitInitializationMode(instance);
extern fmi3Status fmi3EnterEventMode(instance);
extern fmi3Status fmi3EnterContinuousTimeMode(instance);
extern fmi3Status fmi3Terminate(instance);
extern fmi3Status fmi3Reset(instance);
extern fmi3Status fmi3GetFloat64(instance, references, size_t, double[], size_t);
extern fmi3Status fmi3SetFloat64(instance, references, size_t, const double[], size_t);
extern fmi3Status fmi3GetInt32(instance, references, size_t, int32_t[], size_t);
extern fmi3Status fmi3GetClock(instance, references, size_t, bool[]);
extern fmi3Status fmi3GetFMUState(instance, fmi3FMUState *);
extern fmi3Status fmi3SetFMUState(instance, fmi3FMUState);
extern fmi3Status fmi3FreeFMUState(instance, fmi3FMUState *);
extern fmi3Status fmi3SerializedFMUStateSize(instance, fmi3FMUState, size_t *);
extern fmi3Status fmi3SerializeFMUState(instance, fmi3FMUState, fmi3Byte[], size_t);
extern fmi3Status fmi3DeserializeFMUState(instance, const fmi3Byte[], size_t, fmi3FMUState *);
extern fmi3Status fmi3GetDirectionalDerivative(instance, references, size_t, references, size_t, const double[],
    size_t, double[], size_t);
extern fmi3Status fmi3GetAdjointDerivative(instance, references, size_t, references, size_t, const double[], size_t,
    double[], size_t);
extern fmi3Status fmi3UpdateDiscreteStates(instance, bool *, bool *, bool *, bool *, bool *, double *);
extern fmi3Status fmi3CompletedIntegratorStep(instance, fmi3Boolean, bool *, bool *);
extern fmi3Status fmi3SetTime(instance, double);
extern fmi3Status fmi3SetContinuousStates(instance, const double[], size_t);
extern fmi3Status fmi3GetContinuousStates(instance, double[], size_t);
extern fmi3Status fmi3GetContinuousStateDerivatives(instance, double[], size_t);
extern fmi3Status fmi3GetEventIndicators(instance, double[], size_t);
extern fmi3Status fmi3GetNumberOfContinuousStates(instance, size_t *);
extern fmi3Status fmi3GetNumberOfEventIndicators(instance, size_t *);
extern fmi3Status fmi3DoStep(instance, double, double, fmi3Boolean, bool *, bool *, bool *, double *);
extern fmi3Status fmi3SetDebugLogging(instance, fmi3Boolean, size_t, const fmi3String[]);
extern fmi3Status fmi3EnterStepMode(instance);
extern fmi3Status fmi3GetNominalsOfContinuousStates(instance, double[], size_t);

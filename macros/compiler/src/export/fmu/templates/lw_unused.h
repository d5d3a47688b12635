/* Functions of the interface for features that the model does not have: variables of other types, clocks,
 * configuration, output derivatives and scheduled execution. */

/* Defines the functions that read and write variables of a type. */
#define LW_NO_VARIABLES(type, read, write, get, set)                                                          \
    LW_EXPORT fmi3Status LW_FMI(get)(fmi3Instance instance, const fmi3ValueReference references[],            \
        size_t count, read, size_t length) {                                                                  \
        LW_BEGIN(LW_ANY, #get)                                                                                \
        (void)references, (void)values, (void)length;                                                         \
        LW_REQUIRE(count == 0, #get, "all variables have the type Float64")                                   \
        return fmi3OK;                                                                                        \
    }                                                                                                         \
    LW_EXPORT fmi3Status LW_FMI(set)(fmi3Instance instance, const fmi3ValueReference references[],            \
        size_t count, write, size_t length) {                                                                 \
        LW_BEGIN(LW_ANY, #set)                                                                                \
        (void)references, (void)values, (void)length;                                                         \
        LW_REQUIRE(count == 0, #set, "all variables have the type Float64")                                   \
        return fmi3OK;                                                                                        \
    }
#define LW_NO_TYPE(type) \
    LW_NO_VARIABLES(type, fmi3##type values[], const fmi3##type values[], fmi3Get##type, fmi3Set##type)

LW_NO_TYPE(Float32)
LW_NO_TYPE(Int8)
LW_NO_TYPE(UInt8)
LW_NO_TYPE(Int16)
LW_NO_TYPE(UInt16)
LW_NO_TYPE(Int32)
LW_NO_TYPE(UInt32)
LW_NO_TYPE(Int64)
LW_NO_TYPE(UInt64)
LW_NO_TYPE(Boolean)
LW_NO_TYPE(String)

/* Defines a function that fails, with the arguments after the instance. */
#define LW_NOT_PROVIDED(name, arguments, message)                         \
    LW_EXPORT fmi3Status LW_FMI(name) arguments {                         \
        LW_BEGIN(LW_ANY, #name)                                           \
        return lw_fail(s, fmi3Error, #name, message);                     \
    }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

LW_NOT_PROVIDED(fmi3GetBinary, (fmi3Instance instance, const fmi3ValueReference references[], size_t count, size_t sizes[],
    fmi3Binary values[], size_t length),
    "all variables have the type Float64")
LW_NOT_PROVIDED(fmi3SetBinary, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const size_t sizes[], const fmi3Binary values[], size_t length),
    "all variables have the type Float64")
LW_NOT_PROVIDED(fmi3GetClock, (fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Clock values[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3SetClock, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Clock values[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3GetIntervalDecimal, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3GetIntervalFraction, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3GetShiftDecimal, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    fmi3Float64 shifts[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3GetShiftFraction, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3SetIntervalDecimal, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 intervals[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3SetIntervalFraction, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3SetShiftDecimal, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 shifts[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3SetShiftFraction, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]),
    "there are no clocks")
LW_NOT_PROVIDED(fmi3GetNumberOfVariableDependencies, (fmi3Instance instance, fmi3ValueReference reference,
    size_t *count),
    "dependencies of elements are not provided")
LW_NOT_PROVIDED(fmi3GetVariableDependencies, (fmi3Instance instance, fmi3ValueReference dependent,
    size_t elements[], fmi3ValueReference independents[], size_t of_independents[], fmi3DependencyKind kinds[],
    size_t count),
    "dependencies of elements are not provided")
LW_NOT_PROVIDED(fmi3EnterConfigurationMode, (fmi3Instance instance),
    "there are no structural parameters")
LW_NOT_PROVIDED(fmi3ExitConfigurationMode, (fmi3Instance instance),
    "there are no structural parameters")
LW_NOT_PROVIDED(fmi3EnterStepMode, (fmi3Instance instance),
    "there is no Event Mode in co-simulation")
LW_NOT_PROVIDED(fmi3GetOutputDerivatives, (fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t length),
    "output derivatives are not provided")
LW_NOT_PROVIDED(fmi3ActivateModelPartition, (fmi3Instance instance, fmi3ValueReference clock,
    fmi3Float64 time),
    "scheduled execution is not supported")

/* There are no discrete states that change in Event Mode before it is updated. */
LW_EXPORT fmi3Status LW_FMI(fmi3EvaluateDiscreteStates)(fmi3Instance instance) {
    LW_BEGIN(LW_INITIALISING | LW_EVENT, "fmi3EvaluateDiscreteStates")
    return fmi3OK;
}

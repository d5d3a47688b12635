#![doc = include_str!("../README.md")]
#![allow(unsafe_code, reason = "functions of C, whose pointers `raw` reads")]
#![allow(clippy::missing_safety_doc, reason = "the header says what pointers are")]
#![allow(clippy::too_many_arguments, reason = "the header has these signatures")]
#![allow(missing_docs, reason = "the header documents the functions")]

mod raw;
mod simulate;
mod table;

use linkwork::TableError;
use linkwork_jit::{Error, Function, Loader, Robot};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Loaded robot, with its names and documentation as C strings.
pub struct LwRobot {
    robot: Robot,
    functions: Vec<Function>,
    /// Names of arguments and results, and documentation, of each function.
    signatures: Vec<Signature>,
    /// Names and units of the lists of the header.
    lists: [Vec<(CString, CString)>; 7],
    name: CString,
}

struct Signature {
    documentation: CString,
    arguments: Vec<(CString, usize)>,
    results: Vec<(CString, usize, usize)>,
}

/// Index of the list of functions among the lists that the C interface describes.
const FUNCTIONS: usize = 5;

enum Failure {
    /// Failure: a null pointer, or a text that is not UTF-8.
    Null,
    /// Failure: an index for which no entry exists.
    Index(usize),
    /// Grid points and values that do not form a table.
    Table(TableError),
    Linkwork(Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Failure {
        Failure::Linkwork(error)
    }
}

impl Failure {
    fn error_code(&self) -> c_int {
        match self {
            Failure::Linkwork(Error::File { .. }) => 1,
            Failure::Linkwork(Error::Syntax(_)) => 2,
            Failure::Linkwork(Error::Mechanism(_)) => 3,
            Failure::Index(_) | Failure::Linkwork(Error::Unknown { .. } | Error::OtherMechanism(_)) => 4,
            Failure::Linkwork(Error::Length { .. } | Error::Arguments { .. }) => 5,
            Failure::Table(_) | Failure::Linkwork(Error::Missing(_) | Error::Value(_)) => 6,
            Failure::Linkwork(Error::Motion { .. }) => 9,
            Failure::Null => 7,
            Failure::Linkwork(_) => 8,
        }
    }

    fn error_text(&self) -> String {
        match self {
            Failure::Null => "a pointer is NULL, or a text is not UTF-8".to_string(),
            Failure::Index(index) => format!("there is no entry {index}"),
            Failure::Table(error) => error.to_string(),
            Failure::Linkwork(error) => error.to_string(),
        }
    }
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Converts a text to a C string; the text is cut at its first zero byte.
fn c_text(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// Runs a function, stores the message of its failure and returns its error code. No panic leaves the C
/// interface.
fn run_guarded(run: impl FnOnce() -> Result<(), Failure>) -> c_int {
    let internal_error = |_| Err(Failure::Linkwork(Error::Internal("a panic".to_string())));
    match catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(internal_error) {
        Ok(()) => 0,
        Err(failure) => {
            let _ = MESSAGE.try_with(|message| message.replace(c_text(&failure.error_text())));
            failure.error_code()
        }
    }
}

/// Runs a function and returns its value, or the value `otherwise` if the function fails.
fn value_or_fallback<T>(otherwise: T, run: impl FnOnce() -> Result<T, Failure>) -> T {
    let mut found = otherwise;
    run_guarded(|| {
        found = run()?;
        Ok(())
    });
    found
}

impl LwRobot {
    fn new(robot: Robot) -> LwRobot {
        let functions: Vec<Function> = robot.functions().collect();
        let name_with_empty_unit = |name: &str| (c_text(name), CString::default());
        let signature_of_function = |f: &Function| Signature {
            documentation: c_text(f.documentation()),
            arguments: f.arguments().iter().map(|(name, length)| (c_text(name), *length)).collect(),
            results: f.results().iter().map(|m| (c_text(m.name), m.rows, m.columns)).collect(),
        };
        let quantities = [robot.configuration(), robot.velocities(), robot.inputs(), robot.parameters()]
            .map(|list| list.iter().map(|entry| (c_text(&entry.name), c_text(&entry.unit))).collect());
        let [configuration, velocities, inputs, parameters] = quantities;
        let frames = robot.frames().iter().map(|name| name_with_empty_unit(name)).collect();
        let names = functions.iter().map(|f| name_with_empty_unit(f.name())).collect();
        let tables = robot.tables().iter().map(|(name, _)| name_with_empty_unit(name)).collect();
        LwRobot {
            signatures: functions.iter().map(signature_of_function).collect(),
            lists: [configuration, velocities, inputs, parameters, frames, names, tables],
            name: c_text(robot.name()),
            functions,
            robot,
        }
    }

    fn names_and_units_of_list(&self, list: c_int) -> Result<&[(CString, CString)], Failure> {
        let index = usize::try_from(list).unwrap_or(usize::MAX);
        self.lists.get(index).map(Vec::as_slice).ok_or(Failure::Index(index))
    }

    fn function_and_signature(&self, index: usize) -> Result<(&Function, &Signature), Failure> {
        self.functions.get(index).zip(self.signatures.get(index)).ok_or(Failure::Index(index))
    }
}

fn load_robot_into(to: *mut *mut LwRobot, load: impl FnOnce() -> Result<Robot, Failure>) -> c_int {
    run_guarded(|| {
        // SAFETY: the header says that the pointer is that of a variable of the caller.
        let to = unsafe { raw::mutable_reference_from_pointer(to) }?;
        *to = std::ptr::null_mut();
        *to = Box::into_raw(Box::new(LwRobot::new(load()?)));
        Ok(())
    })
}

/// Returns the text of options passed from C; a null pointer counts as an empty text.
unsafe fn read_c_options_text<'a>(options: *const c_char) -> Result<&'a str, Failure> {
    // SAFETY: as the caller promises.
    if options.is_null() { Ok("") } else { unsafe { raw::text(options) } }
}

#[unsafe(no_mangle)]
pub extern "C" fn lw_message() -> *const c_char {
    MESSAGE.try_with(|message| message.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_load(path: *const c_char, more: *const c_char, to: *mut *mut LwRobot) -> c_int {
    // SAFETY: texts of the caller, as the header says.
    load_robot_into(to, || unsafe {
        Ok(Loader::file(raw::text(path)?).options(read_c_options_text(more)?).load()?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_declare(
    text: *const c_char,
    more: *const c_char,
    to: *mut *mut LwRobot,
) -> c_int {
    // SAFETY: texts of the caller, as the header says.
    load_robot_into(to, || unsafe {
        Ok(Loader::text(raw::text(text)?).options(read_c_options_text(more)?).load()?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_copy(robot: *const LwRobot, to: *mut *mut LwRobot) -> c_int {
    // SAFETY: a robot of this library, as the header says.
    load_robot_into(to, || Ok(unsafe { raw::shared(robot) }?.robot.clone()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_free(robot: *mut LwRobot) {
    run_guarded(|| {
        // SAFETY: a robot of this library that was not freed, as the header says.
        unsafe { raw::free(robot) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_mechanism(robot: *const LwRobot) -> *const c_char {
    // SAFETY: a robot of this library, as the header says.
    value_or_fallback(std::ptr::null(), || Ok(unsafe { raw::shared(robot) }?.name.as_ptr()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_count(robot: *const LwRobot, list: c_int) -> usize {
    // SAFETY: a robot of this library, as the header says.
    value_or_fallback(0, || Ok(unsafe { raw::shared(robot) }?.names_and_units_of_list(list)?.len()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_name(robot: *const LwRobot, list: c_int, index: usize) -> *const c_char {
    value_or_fallback(std::ptr::null(), || {
        // SAFETY: a robot of this library, as the header says.
        let list = unsafe { raw::shared(robot) }?.names_and_units_of_list(list)?;
        Ok(list.get(index).ok_or(Failure::Index(index))?.0.as_ptr())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_unit(robot: *const LwRobot, list: c_int, index: usize) -> *const c_char {
    value_or_fallback(std::ptr::null(), || {
        // SAFETY: a robot of this library, as the header says.
        let list = unsafe { raw::shared(robot) }?.names_and_units_of_list(list)?;
        Ok(list.get(index).ok_or(Failure::Index(index))?.1.as_ptr())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_index(
    robot: *const LwRobot,
    list: c_int,
    name: *const c_char,
    to: *mut usize,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, a text and a variable of the caller, as the header says.
        let (robot, name, to) =
            unsafe { (raw::shared(robot)?, raw::text(name)?, raw::mutable_reference_from_pointer(to)?) };
        let is_searched_name = |known: &CStr| known.to_bytes() == name.as_bytes();
        let found =
            robot.names_and_units_of_list(list)?.iter().position(|(known, _)| is_searched_name(known));
        let kinds = ["coordinate", "velocity", "input", "parameter", "frame", "function", "table"];
        *to = match found {
            Some(index) => index,
            None if list as usize == FUNCTIONS => {
                return Err(robot.robot.function(name).err().map_or(Failure::Null, Failure::from));
            }
            None => {
                let help = "see lw_name".to_string();
                let error = Error::Unknown { kind: kinds[list as usize], name: name.to_string(), help };
                return Err(error.into());
            }
        };
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_set_parameter(robot: *mut LwRobot, index: usize, number: f64) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library that nothing else uses now, as the header says.
        let robot = &mut unsafe { raw::mutable_reference_from_pointer(robot) }?.robot;
        let name = robot.parameters().get(index).ok_or(Failure::Index(index))?.name.clone();
        Ok(robot.set_parameter(&name, number)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_parameter(robot: *const LwRobot, index: usize, to: *mut f64) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library and a variable of the caller, as the header says.
        let (robot, to) = unsafe { (raw::shared(robot)?, raw::mutable_reference_from_pointer(to)?) };
        *to = *robot.robot.parameter_values().get(index).ok_or(Failure::Index(index))?;
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_validate(robot: *const LwRobot) -> c_int {
    // SAFETY: a robot of this library, as the header says.
    run_guarded(|| Ok(unsafe { raw::shared(robot) }?.robot.validate()?))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_limits(
    robot: *const LwRobot,
    lower: *mut f64,
    upper: *mut f64,
    velocity: *mut f64,
    effort: *mut f64,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, as the header says.
        let robot = &unsafe { raw::shared(robot) }?.robot;
        let n = robot.nv();
        // SAFETY: arrays of NV values, as the header says.
        let [lower, upper, velocity, effort] =
            [lower, upper, velocity, effort].map(|to| unsafe { raw::array_mut(to, n) });
        let (lower, upper, velocity, effort) = (lower?, upper?, velocity?, effort?);
        lower.fill(f64::NEG_INFINITY);
        for list in [&mut *upper, &mut *velocity, &mut *effort] {
            list.fill(f64::INFINITY);
        }
        for limit in robot.limits()? {
            let k = limit.index;
            (lower[k], upper[k], velocity[k], effort[k]) =
                (limit.lower, limit.upper, limit.velocity, limit.effort);
        }
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_documentation(robot: *const LwRobot, function: usize) -> *const c_char {
    value_or_fallback(std::ptr::null(), || {
        // SAFETY: a robot of this library, as the header says.
        Ok(unsafe { raw::shared(robot) }?.function_and_signature(function)?.1.documentation.as_ptr())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_arguments(robot: *const LwRobot, function: usize) -> usize {
    // SAFETY: a robot of this library, as the header says.
    value_or_fallback(0, || {
        Ok(unsafe { raw::shared(robot) }?.function_and_signature(function)?.1.arguments.len())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_argument(
    robot: *const LwRobot,
    function: usize,
    argument: usize,
    name: *mut *const c_char,
    length: *mut usize,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library and variables of the caller, as the header says.
        let (robot, to, size) = unsafe {
            (
                raw::shared(robot)?,
                raw::mutable_reference_from_pointer(name)?,
                raw::mutable_reference_from_pointer(length)?,
            )
        };
        let found = robot
            .function_and_signature(function)?
            .1
            .arguments
            .get(argument)
            .ok_or(Failure::Index(argument))?;
        (*to, *size) = (found.0.as_ptr(), found.1);
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_results(robot: *const LwRobot, function: usize) -> usize {
    // SAFETY: a robot of this library, as the header says.
    value_or_fallback(0, || {
        Ok(unsafe { raw::shared(robot) }?.function_and_signature(function)?.1.results.len())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_result(
    robot: *const LwRobot,
    function: usize,
    result: usize,
    name: *mut *const c_char,
    rows: *mut usize,
    columns: *mut usize,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library and variables of the caller, as the header says.
        let (robot, to) = unsafe { (raw::shared(robot)?, raw::mutable_reference_from_pointer(name)?) };
        // SAFETY: as before.
        let (rows, columns) = unsafe {
            (raw::mutable_reference_from_pointer(rows)?, raw::mutable_reference_from_pointer(columns)?)
        };
        let found =
            robot.function_and_signature(function)?.1.results.get(result).ok_or(Failure::Index(result))?;
        (*to, *rows, *columns) = (found.0.as_ptr(), found.1, found.2);
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_length(robot: *const LwRobot, function: usize) -> usize {
    // SAFETY: a robot of this library, as the header says.
    value_or_fallback(0, || Ok(unsafe { raw::shared(robot) }?.function_and_signature(function)?.0.length()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_compile(robot: *const LwRobot, function: usize) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, as the header says.
        unsafe { raw::shared(robot) }?.function_and_signature(function)?.0.compile();
        Ok(())
    })
}

/// Maximum number of arguments of a function called from C.
const ARGUMENTS: usize = 12;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_call(
    robot: *const LwRobot,
    function: usize,
    values: *const *const f64,
    results: *mut f64,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, as the header says.
        let robot = unsafe { raw::shared(robot) }?;
        let (f, signature) = robot.function_and_signature(function)?;
        let count = signature.arguments.len();
        // SAFETY: pointers to the arguments and the results, of the lengths that the header says.
        let (pointers, out) = unsafe { (raw::array(values, count)?, raw::array_mut(results, f.length())?) };
        let mut lists: [&[f64]; ARGUMENTS] = [&[]; ARGUMENTS];
        for ((list, pointer), (_, length)) in lists.iter_mut().zip(pointers).zip(&signature.arguments) {
            // SAFETY: as before.
            *list = unsafe { raw::array(*pointer, *length) }?;
        }
        Ok(robot.robot.evaluate_into(f, &lists[..count], out)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_call_many(
    robot: *const LwRobot,
    function: usize,
    count: usize,
    arguments: usize,
    values: *const *const f64,
    lengths: *const usize,
    results: *mut f64,
    length: usize,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, as the header says.
        let robot = unsafe { raw::shared(robot) }?;
        let f = robot.function_and_signature(function)?.0;
        // SAFETY: lists of `arguments` pointers and lengths, and an array of `length` values.
        let (pointers, lengths, out) = unsafe {
            (
                raw::array(values, arguments)?,
                raw::array(lengths, arguments)?,
                raw::array_mut(results, length)?,
            )
        };
        let mut lists: [&[f64]; ARGUMENTS] = [&[]; ARGUMENTS];
        for ((list, pointer), length) in lists.iter_mut().zip(pointers).zip(lengths) {
            // SAFETY: arrays of these lengths.
            *list = unsafe { raw::array(*pointer, *length) }?;
        }
        Ok(robot.robot.evaluate_many_into(f, count, &lists[..arguments.min(ARGUMENTS)], out)?)
    })
}

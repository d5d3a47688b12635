//! Contenders of the comparison that are functions of shared libraries.
//!
//! A library with algorithms for any robot (`peers/pinocchio.cpp`, `peers/rust`) exports
//!
//! - `void *peer_open(const char *folder, const double *states, size_t length, size_t count)`: opens a robot
//!   with `count` states. Together the states have `length` numbers, those of `q`, `v`, `a` and `τ` of each
//!   in Linkwork's order. Returns null if the robot is not available.
//! - `void (*peer_step_fn(void *robot, size_t function, size_t variant))(void *robot, size_t state)`: returns
//!   the function that evaluates one state, or null.
//! - `void peer_result(void *robot, size_t function, size_t state, double *out)`: writes the result of the
//!   last step in Linkwork's order. Values that the peer stores in another form are converted here and in
//!   `peer_open`, outside of the measured time.
//!
//! C that CasADi has generated has an interface of its own.

use super::contender::{Contender, ContenderOwner, MeasuredFunction};
use libloading::Library;
use std::ffi::{CString, c_char, c_int, c_longlong, c_void};
use std::path::Path;

type OpenPeerFunction = unsafe extern "C" fn(*const c_char, *const f64, usize, usize) -> *mut c_void;
type EvaluateStateFunction = unsafe extern "C" fn(*mut c_void, usize);
type EvaluateStateFunctionLookup =
    unsafe extern "C" fn(*mut c_void, usize, usize) -> Option<EvaluateStateFunction>;
type ReadResultFunction = unsafe extern "C" fn(*mut c_void, usize, usize, *mut f64);

/// States for the calls, as a matrix with one row of numbers per state.
#[derive(Clone, Copy)]
pub struct StateRows<'a> {
    /// Number of coordinates of the robot.
    pub nq: usize,
    /// Number of velocities of the robot.
    pub nv: usize,
    /// Values of all states; each row consists of `q`, `v`, `a` and `τ`.
    pub numbers: &'a [f64],
}

impl StateRows<'_> {
    fn row_length(&self) -> usize {
        self.nq + 3 * self.nv
    }

    fn row_count(&self) -> usize {
        self.numbers.len() / self.row_length()
    }
}

/// Robot of a peer library with general algorithms.
struct PeerContender {
    owner: ContenderOwner,
    function: usize,
    variant: usize,
    robot: *mut c_void,
    step: EvaluateStateFunction,
    take: ReadResultFunction,
    states: usize,
    size: usize,
}

/// Returns all implementations that a library offers for a function. Libraries are never unloaded.
pub fn peer_contenders_of_library(
    path: &Path,
    owner: ContenderOwner,
    folder: &Path,
    function: MeasuredFunction,
    rows: StateRows<'_>,
) -> Vec<Box<dyn Contender>> {
    let offered = load_shared_library(path).and_then(|library| {
        let folder = CString::new(folder.to_str()?).ok()?;
        // SAFETY: the types are those that the documentation of this file states, and the sources in `peers`
        // have them.
        unsafe {
            let open: OpenPeerFunction = *library.get(b"peer_open\0").ok()?;
            let find: EvaluateStateFunctionLookup = *library.get(b"peer_step_fn\0").ok()?;
            let take: ReadResultFunction = *library.get(b"peer_result\0").ok()?;
            let robot = open(folder.as_ptr(), rows.numbers.as_ptr(), rows.numbers.len(), rows.row_count());
            let (states, size) = (rows.row_count(), function.result_column_count(rows.nv) * rows.nv);
            let number = function as usize;
            let steps = (0..).map_while(|variant| find(robot, number, variant)).enumerate();
            let peer_of_variant = |(variant, step)| PeerContender {
                owner,
                function: number,
                variant,
                robot,
                step,
                take,
                states,
                size,
            };
            Some(if robot.is_null() { Vec::new() } else { steps.map(peer_of_variant).collect() })
        }
    });
    let boxed = offered.unwrap_or_default().into_iter();
    boxed.map(|peer| Box::new(peer) as Box<dyn Contender>).collect()
}

impl Contender for PeerContender {
    fn owner(&self) -> ContenderOwner {
        self.owner
    }

    fn variant_name(&self) -> String {
        self.variant.to_string()
    }

    fn evaluate_all_states(&mut self) {
        for state in 0..self.states {
            // SAFETY: the robot is open, and `state` is the index of one of its states.
            unsafe { (self.step)(self.robot, state) };
        }
    }

    fn result_at_state(&mut self, state: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.size];
        // SAFETY: as above; `out` has the size of this function's result.
        unsafe {
            (self.step)(self.robot, state);
            (self.take)(self.robot, self.function, state, out.as_mut_ptr());
        }
        out
    }
}

type CasadiFunctionPointer =
    unsafe extern "C" fn(*mut *const f64, *mut *mut f64, *mut c_longlong, *mut f64, c_int) -> c_int;
type WorkSizeFunction =
    unsafe extern "C" fn(*mut c_longlong, *mut c_longlong, *mut c_longlong, *mut c_longlong) -> c_int;

/// Function generated by CasADi, with its working storage.
struct CasadiContender {
    variant: String,
    call: CasadiFunctionPointer,
    /// Pointers to `q`, `v` and the third argument of every state.
    arguments: Vec<[*const f64; 3]>,
    /// Argument pointers of one call of CasADi's code, which writes results behind the first three.
    given: Vec<*const f64>,
    out: Vec<f64>,
    results: Vec<*mut f64>,
    integers: Vec<c_longlong>,
    numbers: Vec<f64>,
}

/// Returns the function of a library that was compiled from C by CasADi. The states must live as long as the
/// library.
pub fn load_casadi_function(
    path: &Path,
    function: MeasuredFunction,
    rows: StateRows<'static>,
) -> Option<Box<dyn Contender>> {
    let library = load_shared_library(path)?;
    // SAFETY: CasADi documents these types for the functions that it generates.
    let (call, [arguments, results, integers, numbers]) = unsafe {
        let work: WorkSizeFunction = *library.get(b"f_work\0").ok()?;
        let call: CasadiFunctionPointer = *library.get(b"f\0").ok()?;
        let mut sizes = [0; 4];
        let [a, r, i, n] = &mut sizes;
        work(a, r, i, n);
        (call, sizes.map(|size| size.max(3) as usize))
    };
    let third = match function {
        MeasuredFunction::Forward | MeasuredFunction::ForwardDerivatives | MeasuredFunction::Step => {
            rows.nq + 2 * rows.nv
        }
        _ => rows.nq + rows.nv,
    };
    let argument_pointers = |row: &'static [f64]| [0, rows.nq, third].map(|start| row[start..].as_ptr());
    Some(Box::new(CasadiContender {
        variant: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        call,
        arguments: rows.numbers.chunks_exact(rows.row_length()).map(argument_pointers).collect(),
        given: vec![std::ptr::null(); arguments],
        out: vec![0.0; function.result_column_count(rows.nv) * rows.nv],
        results: vec![std::ptr::null_mut(); results],
        integers: vec![0; integers],
        numbers: vec![0.0; numbers],
    }))
}

impl CasadiContender {
    fn evaluate_state(&mut self, state: usize) {
        self.given[..3].copy_from_slice(&self.arguments[state]);
        self.results[0] = self.out.as_mut_ptr();
        let (given, results) = (self.given.as_mut_ptr(), self.results.as_mut_ptr());
        // SAFETY: all arrays have the sizes that the library requires, and the result that of the function.
        unsafe {
            (self.call)(given, results, self.integers.as_mut_ptr(), self.numbers.as_mut_ptr(), 0);
        }
    }
}

impl Contender for CasadiContender {
    fn owner(&self) -> ContenderOwner {
        ContenderOwner::Casadi
    }

    fn variant_name(&self) -> String {
        self.variant.clone()
    }

    fn evaluate_all_states(&mut self) {
        for state in 0..self.arguments.len() {
            self.evaluate_state(state);
        }
    }

    fn result_at_state(&mut self, state: usize) -> Vec<f64> {
        self.evaluate_state(state);
        self.out.clone()
    }
}

/// Loads a shared library, which is never unloaded.
fn load_shared_library(path: &Path) -> Option<&'static Library> {
    if !path.exists() {
        return None;
    }
    // SAFETY: the libraries come from `peers/run`; their initialisers only do the work of their languages.
    match unsafe { Library::new(path) } {
        Ok(library) => Some(Box::leak(Box::new(library))),
        Err(error) => {
            eprintln!("peers: {error}");
            None
        }
    }
}

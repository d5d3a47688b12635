//! Peers as contenders: functions of shared libraries.
//!
//! A library with algorithms for any robot (`peers/pinocchio.cpp`, `peers/rust`) exports
//!
//! - `void *peer_open(const char *folder, const double *states, size_t length, size_t count)`: a robot with
//!   `count` states, which have `length` numbers together, each those of `q`, `v`, `a` and `τ` as Linkwork
//!   orders them; null if it cannot be had;
//! - `void (*peer_step(void *robot, size_t function, size_t variant))(void *robot, size_t state)`: what
//!   evaluates one state, null if there is none;
//! - `void peer_result(void *robot, size_t function, size_t state, double *out)`: the result of the last
//!   step, as Linkwork orders it. What the peer keeps in another form is turned round here and in
//!   `peer_open`, where no clock runs.
//!
//! C that CasADi has generated has an interface of its own.

use super::contender::{Contender, Function, Owner};
use libloading::Library;
use std::ffi::{CString, c_char, c_int, c_longlong, c_void};
use std::path::Path;

type Open = unsafe extern "C" fn(*const c_char, *const f64, usize, usize) -> *mut c_void;
type Step = unsafe extern "C" fn(*mut c_void, usize);
type FindStep = unsafe extern "C" fn(*mut c_void, usize, usize) -> Option<Step>;
type TakeResult = unsafe extern "C" fn(*mut c_void, usize, usize, *mut f64);

/// States as a row of numbers each.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    /// Number of coordinates.
    pub nq: usize,
    /// Number of velocities.
    pub nv: usize,
    /// Rows of `q`, `v`, `a` and `τ`.
    pub numbers: &'a [f64],
}

impl Rows<'_> {
    fn length(&self) -> usize {
        self.nq + 3 * self.nv
    }

    fn count(&self) -> usize {
        self.numbers.len() / self.length()
    }
}

/// A robot of a library that has algorithms for any.
struct Peer {
    owner: Owner,
    function: usize,
    variant: usize,
    robot: *mut c_void,
    step: Step,
    take: TakeResult,
    states: usize,
    size: usize,
}

/// All that a library offers for a function. Nothing is ever unloaded.
pub fn peers(
    path: &Path,
    owner: Owner,
    folder: &Path,
    function: Function,
    rows: Rows<'_>,
) -> Vec<Box<dyn Contender>> {
    let offered = load(path).and_then(|library| {
        let folder = CString::new(folder.to_str()?).ok()?;
        // SAFETY: the types are those that the head of this file states and the sources in `peers` have.
        unsafe {
            let open: Open = *library.get(b"peer_open\0").ok()?;
            let find: FindStep = *library.get(b"peer_step\0").ok()?;
            let take: TakeResult = *library.get(b"peer_result\0").ok()?;
            let robot = open(folder.as_ptr(), rows.numbers.as_ptr(), rows.numbers.len(), rows.count());
            let (states, size) = (rows.count(), function.columns(rows.nv) * rows.nv);
            let number = function as usize;
            let steps = (0..).map_while(|variant| find(robot, number, variant)).enumerate();
            let peer =
                |(variant, step)| Peer { owner, function: number, variant, robot, step, take, states, size };
            Some(if robot.is_null() { Vec::new() } else { steps.map(peer).collect() })
        }
    });
    let boxed = offered.unwrap_or_default().into_iter();
    boxed.map(|peer| Box::new(peer) as Box<dyn Contender>).collect()
}

impl Contender for Peer {
    fn owner(&self) -> Owner {
        self.owner
    }

    fn variant(&self) -> String {
        self.variant.to_string()
    }

    fn pass(&mut self) {
        for state in 0..self.states {
            // SAFETY: the robot is open, and it has as many states.
            unsafe { (self.step)(self.robot, state) };
        }
    }

    fn result(&mut self, state: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.size];
        // SAFETY: as above; `out` has the size of this function's result.
        unsafe {
            (self.step)(self.robot, state);
            (self.take)(self.robot, self.function, state, out.as_mut_ptr());
        }
        out
    }
}

type Generated =
    unsafe extern "C" fn(*mut *const f64, *mut *mut f64, *mut c_longlong, *mut f64, c_int) -> c_int;
type Work = unsafe extern "C" fn(*mut c_longlong, *mut c_longlong, *mut c_longlong, *mut c_longlong) -> c_int;

/// A function that CasADi has generated, with the room it needs.
struct Casadi {
    variant: String,
    call: Generated,
    /// Pointers to `q`, `v` and the third argument of every state.
    arguments: Vec<[*const f64; 3]>,
    /// The same for one call; CasADi writes behind the three.
    given: Vec<*const f64>,
    out: Vec<f64>,
    results: Vec<*mut f64>,
    integers: Vec<c_longlong>,
    numbers: Vec<f64>,
}

/// The function of a library that was compiled from C by CasADi. The states must live as long.
pub fn casadi(path: &Path, function: Function, rows: Rows<'static>) -> Option<Box<dyn Contender>> {
    let library = load(path)?;
    // SAFETY: CasADi documents these types for the functions that it generates.
    let (call, [arguments, results, integers, numbers]) = unsafe {
        let work: Work = *library.get(b"f_work\0").ok()?;
        let call: Generated = *library.get(b"f\0").ok()?;
        let mut sizes = [0; 4];
        let [a, r, i, n] = &mut sizes;
        work(a, r, i, n);
        (call, sizes.map(|size| size.max(3) as usize))
    };
    let third = match function {
        Function::Forward | Function::ForwardDerivatives | Function::Step => rows.nq + 2 * rows.nv,
        _ => rows.nq + rows.nv,
    };
    let pointers = |row: &'static [f64]| [0, rows.nq, third].map(|start| row[start..].as_ptr());
    Some(Box::new(Casadi {
        variant: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        call,
        arguments: rows.numbers.chunks_exact(rows.length()).map(pointers).collect(),
        given: vec![std::ptr::null(); arguments],
        out: vec![0.0; function.columns(rows.nv) * rows.nv],
        results: vec![std::ptr::null_mut(); results],
        integers: vec![0; integers],
        numbers: vec![0.0; numbers],
    }))
}

impl Casadi {
    fn evaluate(&mut self, state: usize) {
        self.given[..3].copy_from_slice(&self.arguments[state]);
        self.results[0] = self.out.as_mut_ptr();
        let (given, results) = (self.given.as_mut_ptr(), self.results.as_mut_ptr());
        // SAFETY: everything has the sizes that the library asks for, and the result that of the function.
        unsafe {
            (self.call)(given, results, self.integers.as_mut_ptr(), self.numbers.as_mut_ptr(), 0);
        }
    }
}

impl Contender for Casadi {
    fn owner(&self) -> Owner {
        Owner::Casadi
    }

    fn variant(&self) -> String {
        self.variant.clone()
    }

    fn pass(&mut self) {
        for state in 0..self.arguments.len() {
            self.evaluate(state);
        }
    }

    fn result(&mut self, state: usize) -> Vec<f64> {
        self.evaluate(state);
        self.out.clone()
    }
}

/// A library that stays loaded.
fn load(path: &Path) -> Option<&'static Library> {
    if !path.exists() {
        return None;
    }
    // SAFETY: the libraries come from `peers/run`; their initialisers do nothing but those of their
    // languages.
    match unsafe { Library::new(path) } {
        Ok(library) => Some(Box::leak(Box::new(library))),
        Err(error) => {
            eprintln!("peers: {error}");
            None
        }
    }
}

//! Access to the pointers that C programs pass. This is the only module that reads and writes through them.

#![allow(unsafe_code, reason = "pointers of callers in C")]

use crate::Failure;
use std::ffi::{CStr, c_char, c_int, c_void};

/// Returns a reference to the value behind a pointer of the caller, or a failure for a null pointer.
///
/// # Safety
///
/// The pointer is null or points to a value that outlives the result.
pub unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, Failure> {
    // SAFETY: as the caller promises.
    unsafe { pointer.as_ref() }.ok_or(Failure::Null)
}

/// Returns a mutable reference to the value behind a pointer of the caller, or a failure for a null pointer.
///
/// # Safety
///
/// The pointer is null or points to a value that outlives the result and that nothing else uses.
pub unsafe fn mutable_reference_from_pointer<'a, T>(pointer: *mut T) -> Result<&'a mut T, Failure> {
    // SAFETY: as the caller promises.
    unsafe { pointer.as_mut() }.ok_or(Failure::Null)
}

/// Returns the text behind a pointer of the caller, or a failure for a null pointer or text that is not
/// UTF-8.
///
/// # Safety
///
/// The pointer is null or points to a text that ends with a zero and outlives the result.
pub unsafe fn text<'a>(pointer: *const c_char) -> Result<&'a str, Failure> {
    if pointer.is_null() {
        return Err(Failure::Null);
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(pointer) }.to_str().map_err(|_| Failure::Null)
}

/// Returns the array behind a pointer of the caller. The pointer of an empty array may be null.
///
/// # Safety
///
/// The pointer is null or points to `length` values that outlive the result.
pub unsafe fn array<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Failure> {
    match (length, pointer.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(Failure::Null),
        _ if exceeds_address_space::<T>(length) => Err(Failure::Index(length)),
        // SAFETY: as the caller promises.
        (_, false) => Ok(unsafe { std::slice::from_raw_parts(pointer, length) }),
    }
}

/// Returns the array behind a pointer of the caller, to be written. The pointer of an empty array may be
/// null.
///
/// # Safety
///
/// The pointer is null or points to `length` values that outlive the result and that nothing else uses.
pub unsafe fn array_mut<'a, T>(pointer: *mut T, length: usize) -> Result<&'a mut [T], Failure> {
    match (length, pointer.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err(Failure::Null),
        _ if exceeds_address_space::<T>(length) => Err(Failure::Index(length)),
        // SAFETY: as the caller promises.
        (_, false) => Ok(unsafe { std::slice::from_raw_parts_mut(pointer, length) }),
    }
}

/// Whether an array of this length is larger than the address space.
fn exceeds_address_space<T>(length: usize) -> bool {
    length > isize::MAX as usize / size_of::<T>().max(1)
}

/// Frees a value that [`Box::into_raw`] returned.
///
/// # Safety
///
/// The pointer is null, or of such a value that was not freed before.
pub unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: as the caller promises.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// C function of the calling program that computes the inputs from time and state.
pub type Control =
    unsafe extern "C" fn(user: *mut c_void, t: f64, q: *const f64, v: *const f64, u: *mut f64) -> c_int;

/// Controller of the calling program: a C function with a pointer to its own data.
pub struct Controller {
    pub control: Control,
    pub user: *mut c_void,
}

// SAFETY: the header says that another thread may call the controller, while the caller waits for it.
unsafe impl Send for Controller {}
// SAFETY: one thread at a time calls it.
unsafe impl Sync for Controller {}

impl Controller {
    /// Calls the controller of the calling program, which writes the inputs `u`.
    pub fn call(&self, t: f64, q: &[f64], v: &[f64], u: &mut [f64]) -> Result<(), String> {
        // SAFETY: the function and its data are those of the caller, and the slices have the lengths that the
        // header says.
        match unsafe { (self.control)(self.user, t, q.as_ptr(), v.as_ptr(), u.as_mut_ptr()) } {
            0 => Ok(()),
            code => Err(format!("the controller ended the run with the code {code}")),
        }
    }
}

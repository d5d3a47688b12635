//! Compilation of programs to machine code, and calls of the code. Together with `kernels`, the only module
//! with `unsafe`.
//!
//! Memory of code is written first, then made executable and never written again. Every load and store of
//! generated code is at a constant index that [`Code::call`] compares with the lengths of its slices.
//!
//! The values of a program with lanes are split into [`pieces`] that fit registers. A program becomes a
//! [`plan`] of steps on registers and memory. `x86` writes them as instructions with AVX2 and FMA; for
//! AArch64 Cranelift generates the code, without lanes.

#![allow(unsafe_code, reason = "calls of generated code, and the functions that it calls")]

#[cfg(any(test, target_arch = "aarch64"))]
mod cranelift;
mod pieces;
mod plan;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::layout::InputLayout;
use crate::table::AnyTable;
use linkwork::__private::{Arithmetic, Evaluate, dispatch_in_any_build};
use linkwork_compiler::expr::Function as Elementary;
use linkwork_compiler::lower::Program;
use pieces::ProgramInPieces;
use plan::{ProgramPlan, WIDEST};
use std::mem::MaybeUninit;

/// Declares functions in the calling convention of generated code, that of System V on all systems.
macro_rules! called {
    ($($(#[$about:meta])* fn $name:ident($($x:ident: $kind:ty),*) $(-> $result:ty)? $body:block)*) => {
        $(
            $(#[$about])*
            #[cfg(target_arch = "x86_64")]
            extern "sysv64" fn $name($($x: $kind),*) $(-> $result)? $body
            $(#[$about])*
            #[cfg(not(target_arch = "x86_64"))]
            extern "C" fn $name($($x: $kind),*) $(-> $result)? $body
        )*
    };
}

/// Machine code as a function of pointers to the inputs, constants, tables, results and further outputs.
#[cfg(target_arch = "x86_64")]
type Entry = unsafe extern "sysv64" fn(*const *const f64, *const f64, *const AnyTable, *mut f64, *mut f64);
#[cfg(not(target_arch = "x86_64"))]
type Entry = unsafe extern "C" fn(*const *const f64, *const f64, *const AnyTable, *mut f64, *mut f64);

/// Four constants in one line of the cache.
#[repr(align(32))]
struct ConstantCacheLine(#[allow(dead_code, reason = "read by generated code")] [f64; 4]);

/// Machine code of a program.
pub(crate) struct Code {
    entry: Entry,
    /// Constants that the machine code loads; their address is fixed while the code exists.
    constants: Box<[ConstantCacheLine]>,
    /// Minimum number of entries of each input of the program.
    lengths: Box<[usize]>,
    /// Number of lookup tables that the code reads.
    tables: usize,
    /// Number of results of the function, and number of further outputs of the program.
    outputs: [usize; 2],
    _memory: ExecutableMemory,
}

/// Memory that contains the machine code. No call is in progress when it is dropped, since a call borrows it.
enum ExecutableMemory {
    #[cfg(target_arch = "x86_64")]
    Pages(#[allow(dead_code, reason = "holds the memory")] memmap2::Mmap),
    #[cfg(any(test, target_arch = "aarch64"))]
    Module(#[allow(dead_code, reason = "holds the memory")] Box<cranelift::OwnedJitModule>),
}

impl Code {
    /// Compiles a program whose first `results` outputs are separate from the others.
    pub fn compile(program: &Program, layout: &InputLayout, results: usize) -> Result<Code, String> {
        #[cfg(target_arch = "x86_64")]
        return Code::assemble_x86_code(program, layout, results);
        #[cfg(target_arch = "aarch64")]
        return Code::compile_with_cranelift(program, layout, results);
    }

    /// Compiles a program, or its variant with lanes, to instructions of this x86-64 processor.
    #[cfg(target_arch = "x86_64")]
    fn assemble_x86_code(program: &Program, layout: &InputLayout, results: usize) -> Result<Code, String> {
        if !x86::is_supported() {
            return Err("the processor has neither AVX2 nor FMA".to_string());
        }
        let pieces = program.simd.as_ref().and_then(|simd| ProgramInPieces::split_program(simd, layout).ok());
        let pieces = pieces.map_or_else(|| ProgramInPieces::split_program(program, layout), Ok)?;
        let mut plan = ProgramPlan::new(pieces, layout, results, x86::REGISTERS)?;
        let bytes = x86::write(&mut plan, results, helper_address)?;
        let memory = memmap2::MmapMut::map_anon(bytes.len()).and_then(|mut memory| {
            memory.copy_from_slice(&bytes);
            memory.make_exec()
        });
        let memory = memory.map_err(|error| error.to_string())?;
        let address = memory.as_ptr();
        Ok(Code::new(
            plan,
            [results, program.outputs.len() - results],
            address,
            ExecutableMemory::Pages(memory),
        ))
    }

    /// Compiles a program to machine code with Cranelift.
    #[cfg(any(test, target_arch = "aarch64"))]
    fn compile_with_cranelift(
        program: &Program,
        layout: &InputLayout,
        results: usize,
    ) -> Result<Code, String> {
        let pieces = ProgramInPieces::split_program(program, layout)?;
        let plan = ProgramPlan::new(pieces, layout, results, cranelift::REGISTERS)?;
        let (module, address) = cranelift::translate(&plan, results, helper_address)?;
        let outputs = [results, program.outputs.len() - results];
        Ok(Code::new(plan, outputs, address, ExecutableMemory::Module(Box::new(module))))
    }

    fn new(plan: ProgramPlan, outputs: [usize; 2], address: *const u8, memory: ExecutableMemory) -> Code {
        // SAFETY: the code at this address was generated with this signature.
        let entry = unsafe { std::mem::transmute::<*const u8, Entry>(address) };
        let four_constants =
            |list: &[f64]| ConstantCacheLine(std::array::from_fn(|k| list.get(k).copied().unwrap_or(0.0)));
        let constants = plan.constants.chunks(4).map(four_constants).collect();
        let lengths = plan.lengths.into();
        Code { entry, constants, lengths, tables: plan.tables, outputs, _memory: memory }
    }

    /// Evaluates the program by its machine code.
    ///
    /// # Panics
    ///
    /// A slice is shorter than its argument or result: callers check lengths before.
    pub fn call(
        &self,
        parameters: &[f64],
        arguments: &[&[f64]],
        tables: &[AnyTable],
        results: &mut [f64],
        more: &mut [f64],
    ) {
        let fits = self.call_if_arguments_satisfy(parameters, arguments, |_, _| true, tables, results, more);
        assert!(fits, "lengths of arguments and results");
    }

    /// Evaluates a program without further outputs if its arguments have these lengths. Returns false
    /// otherwise.
    #[inline]
    pub fn call_if_lengths_match(
        &self,
        parameters: &[f64],
        arguments: &[&[f64]],
        lengths: &[usize],
        tables: &[AnyTable],
        results: &mut [f64],
    ) -> bool {
        let has_length = |k: usize, list: &[f64]| lengths.get(k).is_some_and(|length| list.len() == *length);
        arguments.len() == lengths.len()
            && self.call_if_arguments_satisfy(parameters, arguments, has_length, tables, results, &mut [])
    }

    /// Evaluates the program if no slice is too short and all arguments satisfy a condition. Returns false
    /// otherwise.
    #[inline]
    fn call_if_arguments_satisfy(
        &self,
        parameters: &[f64],
        arguments: &[&[f64]],
        condition: impl Fn(usize, &[f64]) -> bool,
        tables: &[AnyTable],
        results: &mut [f64],
        more: &mut [f64],
    ) -> bool {
        let mut pointers = [const { MaybeUninit::<*const f64>::uninit() }; InputLayout::MOST];
        let [own, lengths @ ..] = &*self.lengths else { return false };
        if parameters.len() < *own
            || arguments.len() != lengths.len()
            || arguments.len() >= pointers.len()
            || tables.len() < self.tables
            || results.len() < self.outputs[0]
            || more.len() < self.outputs[1]
        {
            return false;
        }
        pointers[0].write(parameters.as_ptr());
        let all = arguments.iter().zip(lengths).zip(&mut pointers[1..]).enumerate();
        for (k, ((list, length), pointer)) in all {
            if list.len() < *length || !condition(k, list) {
                return false;
            }
            pointer.write(list.as_ptr());
        }
        // SAFETY: the code reads `lengths` entries of the inputs, the constants and the tables, and writes
        // `outputs` entries; all of them exist, as checked here. The pointers to all inputs are written.
        unsafe {
            (self.entry)(
                pointers.as_ptr().cast(),
                self.constants.as_ptr().cast(),
                tables.as_ptr(),
                results.as_mut_ptr(),
                more.as_mut_ptr(),
            );
        }
        true
    }
}

/// Returns the address of a function that generated code calls.
fn helper_address(name: &str) -> Option<*const u8> {
    macro_rules! unary {
        ($($f:ident)+) => {
            match name {
                "atan2" => atan2 as *const u8,
                "pow" => pow as *const u8,
                "min" => minimum as *const u8,
                "max" => maximum as *const u8,
                "lookup" => look_up_table as *const u8,
                "sines" => write_sines_and_cosines as *const u8,
                $(_ if name == Elementary::$f.function_name() => {
                    called! { fn f(x: f64) -> f64 { Elementary::$f.evaluate_at(x) } }
                    f as *const u8
                })+
                _ => return None,
            }
        };
    }
    Some(unary! {
        Sin Cos Tan Asin Acos Atan Sinh Cosh Tanh Exp Ln Signum IsaTemperature IsaLapseRate IsaPressure
    })
}

called! {
    fn atan2(a: f64, b: f64) -> f64 {
        a.atan2(b)
    }

    fn pow(a: f64, b: f64) -> f64 {
        a.powf(b)
    }

    fn minimum(a: f64, b: f64) -> f64 {
        a.min(b)
    }

    fn maximum(a: f64, b: f64) -> f64 {
        a.max(b)
    }

    /// Returns the value or a derivative of a lookup table. The orders of differentiation are two bits each.
    fn look_up_table(tables: *const AnyTable, table: u64, orders: u64, x: f64, y: f64, z: f64) -> f64 {
        // SAFETY: generated code passes an index below the number of tables, which `Code::call` checks.
        let table = unsafe { &*tables.add(table as usize) };
        table.value_or_derivative([x, y, z], [0, 2, 4].map(|shift| (orders >> shift & 3) as u8))
    }

    /// Writes the sines, then the cosines, of each group of angles into the array after the angles of the
    /// group; see [`plan::AngleGroup`]. `count` is the number of angles of all groups.
    fn write_sines_and_cosines(array: *mut f64, count: u64) {
        // SAFETY: generated code passes an array of `3 * count` numbers on its stack.
        let array = unsafe { std::slice::from_raw_parts_mut(array, 3 * count as usize) };
        dispatch_in_any_build::<0, f64, _, _>(&SineCosineEvaluation, array);
    }
}

struct SineCosineEvaluation;

impl Evaluate<0, &mut [f64]> for SineCosineEvaluation {
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, array: &mut [f64]) {
        let (groups, last) = array.as_chunks_mut::<{ 3 * WIDEST }>();
        groups.iter_mut().for_each(|group| write_group_sines_and_cosines::<A, WIDEST>(group));
        match last.len() {
            3 => write_group_sines_and_cosines::<A, 1>(last),
            6 => write_group_sines_and_cosines::<A, 2>(last),
            _ => {}
        }
    }
}

/// Writes the sines, then the cosines, of `N` angles after them.
#[inline(always)]
fn write_group_sines_and_cosines<A: Arithmetic, const N: usize>(group: &mut [f64]) {
    if let ([angles, sines, cosines], _) = group.as_chunks_mut::<N>() {
        (*sines, *cosines) = A::sin_cos_all(*angles);
    }
}

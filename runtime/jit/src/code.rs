//! Machine code of programs, by Cranelift. Together with `kernels`, the only module with `unsafe`.
//!
//! Memory of code is written first, then made executable and never written again. Every load and store of
//! generated code is at a constant index that [`Code::call`] compares with the lengths of its slices.

#![allow(unsafe_code, reason = "calls of generated code, and the functions that it calls")]

use crate::layout::Layout;
use crate::table::AnyTable;
use cranelift_codegen::ir::{
    AbiParam, InstBuilder, MemFlags, Signature, StackSlotData, StackSlotKind, Value, types,
};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module, default_libcall_names};
use linkwork::__private::{Arithmetic, Evaluate, dispatch};
use linkwork_compiler::expr::{Extreme, Function as Elementary, Lookup, Symbol};
use linkwork_compiler::lower::{Angles, Op, Operand, Program};
use std::collections::HashMap;
use std::mem::ManuallyDrop;
use std::sync::OnceLock;

/// Pointers to the inputs, constants, tables, results and further outputs.
type Entry = unsafe extern "C" fn(*const *const f64, *const f64, *const AnyTable, *mut f64, *mut f64);

/// A compiled program.
pub(crate) struct Code {
    entry: Entry,
    /// Constants that the code loads; not moved while it exists.
    constants: Box<[f64]>,
    /// Minimum length of each input.
    lengths: Box<[usize]>,
    /// Number of tables that the code looks up.
    tables: usize,
    /// Numbers of results and of further outputs.
    outputs: [usize; 2],
    module: ManuallyDrop<JITModule>,
}

// SAFETY: the module is only used to free its memory on drop, and generated code has no state.
unsafe impl Send for Code {}
// SAFETY: as above.
unsafe impl Sync for Code {}

impl Drop for Code {
    fn drop(&mut self) {
        // SAFETY: the module is not used afterwards, and no call of the code is in progress, since a call
        // borrows it.
        unsafe { ManuallyDrop::take(&mut self.module).free_memory() }
    }
}

impl Code {
    /// Compiles a program whose first `results` outputs are separate from the others.
    pub fn compile(program: &Program, layout: &Layout, results: usize) -> Result<Code, String> {
        let mut builder = JITBuilder::with_isa(target()?, default_libcall_names());
        for (name, address) in HELPERS {
            builder.symbol(*name, address());
        }
        let mut module = JITModule::new(builder);
        let Written { id, constants, lengths, tables } = match write(&mut module, program, layout, results) {
            Ok(written) => written,
            Err(error) => {
                // SAFETY: no function of the module was called.
                unsafe { module.free_memory() };
                return Err(error);
            }
        };
        let address = module.get_finalized_function(id);
        // SAFETY: the code at this address was generated with this signature.
        let entry = unsafe { std::mem::transmute::<*const u8, Entry>(address) };
        Ok(Code {
            entry,
            constants: constants.into(),
            lengths: lengths.into(),
            tables,
            outputs: [results, program.outputs.len() - results],
            module: ManuallyDrop::new(module),
        })
    }

    /// Evaluates the program.
    ///
    /// # Panics
    ///
    /// A slice is shorter than its argument or result: callers check lengths before.
    pub fn call(&self, inputs: &[&[f64]], tables: &[AnyTable], results: &mut [f64], more: &mut [f64]) {
        let mut pointers = [std::ptr::null(); Layout::MOST];
        assert!(self.lengths.len() <= inputs.len() && inputs.len() <= pointers.len(), "inputs");
        for ((input, length), pointer) in inputs.iter().zip(&self.lengths).zip(&mut pointers) {
            assert!(input.len() >= *length, "the length of an input");
            *pointer = input.as_ptr();
        }
        assert!(tables.len() >= self.tables, "tables");
        assert!(results.len() >= self.outputs[0] && more.len() >= self.outputs[1], "results");
        // SAFETY: the code reads `lengths` entries of the inputs, the constants and the tables, and writes
        // `outputs` entries; all of them exist, as checked here.
        unsafe {
            (self.entry)(
                pointers.as_ptr(),
                self.constants.as_ptr(),
                tables.as_ptr(),
                results.as_mut_ptr(),
                more.as_mut_ptr(),
            );
        }
    }
}

/// The host's instruction set.
fn target() -> Result<OwnedTargetIsa, String> {
    static TARGET: OnceLock<Result<OwnedTargetIsa, String>> = OnceLock::new();
    let make = || {
        let mut flags = settings::builder();
        for (name, value) in [
            ("opt_level", "speed"),
            ("enable_verifier", if cfg!(debug_assertions) { "true" } else { "false" }),
            ("use_colocated_libcalls", "false"),
            ("is_pic", "false"),
            ("unwind_info", "false"),
        ] {
            flags.set(name, value).map_err(|error| error.to_string())?;
        }
        let builder = cranelift_native::builder()?;
        builder.finish(settings::Flags::new(flags)).map_err(|error| error.to_string())
    };
    TARGET.get_or_init(make).clone()
}

/// Whether the host multiplies and adds in one instruction.
fn has_fused() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    true
}

/// Name of a function that generated code calls, and what returns its address.
type Helper = (&'static str, fn() -> *const u8);

/// Functions that generated code calls.
const HELPERS: &[Helper] = {
    macro_rules! unary {
        ($($name:literal $f:expr),+ $(,)?) => {
            &[
                $(($name, || {
                    extern "C" fn helper(x: f64) -> f64 {
                        $f.apply(x)
                    }
                    helper as *const u8
                }),)+
                ("atan2", || atan2 as *const u8),
                ("pow", || pow as *const u8),
                ("min", || minimum as *const u8),
                ("max", || maximum as *const u8),
                ("lookup", || lookup as *const u8),
                ("sines", || sines as *const u8),
            ]
        };
    }
    unary! {
        "sin" Elementary::Sin,
        "cos" Elementary::Cos,
        "tan" Elementary::Tan,
        "asin" Elementary::Asin,
        "acos" Elementary::Acos,
        "atan" Elementary::Atan,
        "sinh" Elementary::Sinh,
        "cosh" Elementary::Cosh,
        "tanh" Elementary::Tanh,
        "exp" Elementary::Exp,
        "ln" Elementary::Ln,
        "signum" Elementary::Signum,
        "isa_temperature" Elementary::IsaTemperature,
        "isa_lapse_rate" Elementary::IsaLapseRate,
        "isa_pressure" Elementary::IsaPressure,
    }
};

extern "C" fn atan2(a: f64, b: f64) -> f64 {
    a.atan2(b)
}

extern "C" fn pow(a: f64, b: f64) -> f64 {
    a.powf(b)
}

extern "C" fn minimum(a: f64, b: f64) -> f64 {
    a.min(b)
}

extern "C" fn maximum(a: f64, b: f64) -> f64 {
    a.max(b)
}

/// Looks a table up. The orders of differentiation are two bits each.
extern "C" fn lookup(tables: *const AnyTable, table: u64, orders: u64, x: f64, y: f64, z: f64) -> f64 {
    // SAFETY: generated code passes an index below the number of tables, which `Code::call` checks.
    let table = unsafe { &*tables.add(table as usize) };
    table.value([x, y, z], [0, 2, 4].map(|shift| (orders >> shift & 3) as u8))
}

/// Number of angles whose sines and cosines are computed together.
const TOGETHER: usize = 8;

/// Writes the sines, then the cosines, of `count` angles into the array behind them; `count` is one, two or
/// four, or a multiple of [`TOGETHER`].
extern "C" fn sines(array: *mut f64, count: u64) {
    let count = count as usize;
    // SAFETY: generated code passes an array of `3 * count` numbers on its stack.
    let array = unsafe { std::slice::from_raw_parts_mut(array, 3 * count) };
    dispatch::<0, f64, _, _>(&SinesAndCosines, (array, count));
}

struct SinesAndCosines;

impl Evaluate<0, (&mut [f64], usize)> for SinesAndCosines {
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, (array, count): (&mut [f64], usize)) {
        let (angles, results) = array.split_at_mut(count);
        let (sines, cosines) = results.split_at_mut(count);
        match count {
            1 => some::<A, 1>(angles, sines, cosines),
            2 => some::<A, 2>(angles, sines, cosines),
            4 => some::<A, 4>(angles, sines, cosines),
            _ => some::<A, TOGETHER>(angles, sines, cosines),
        }
    }
}

#[inline(always)]
fn some<A: Arithmetic, const N: usize>(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    let (angles, _) = angles.as_chunks::<N>();
    let ((sines, _), (cosines, _)) = (sines.as_chunks_mut::<N>(), cosines.as_chunks_mut::<N>());
    for ((angles, sines), cosines) in angles.iter().zip(sines).zip(cosines) {
        (*sines, *cosines) = A::sin_cos_all(*angles);
    }
}

/// A function of the module with its constants, the lengths of its inputs and the number of its tables.
struct Written {
    id: FuncId,
    constants: Vec<f64>,
    lengths: Vec<usize>,
    tables: usize,
}

/// Translates a program to a function of the module. Sines and cosines of angles that are arithmetic
/// expressions of the inputs are computed together by a function that then calls the body: loads of the body
/// are from memory that does not change.
fn write(
    module: &mut JITModule,
    program: &Program,
    layout: &Layout,
    results: usize,
) -> Result<Written, String> {
    let angles = Angles::find(program);
    let list = angles.widest_first(program, |_| 1);
    let padded = match list.len() {
        count @ 0..=2 => count,
        3..=4 => 4,
        count => count.next_multiple_of(TOGETHER),
    };
    let mut slots = HashMap::new();
    for (at, angle) in list.iter().enumerate() {
        for (value, first) in [(angle.sine, padded), (angle.cosine, 2 * padded)] {
            slots.extend(value.map(|k| (k, first + at)));
        }
    }
    let mut state = ModuleState { lengths: vec![0; layout.len()], ..ModuleState::default() };
    let id = define(module, "body", 6, (program, layout), &mut state, |t| t.body(&angles, slots, results))?;
    let id = match list.is_empty() {
        true => id,
        false => define(module, "program", 5, (program, layout), &mut state, |t| {
            let list: Vec<Operand> = list.iter().map(|angle| angle.angle).collect();
            t.angles(&angles, &list, padded, id)
        })?,
    };
    module.finalize_definitions().map_err(|error| error.to_string())?;
    let ModuleState { constants, lengths, tables, .. } = state;
    Ok(Written { id, constants, lengths, tables })
}

/// Defines a function of several pointers.
fn define(
    module: &mut JITModule,
    name: &str,
    parameters: usize,
    (program, layout): (&Program, &Layout),
    state: &mut ModuleState,
    fill: impl FnOnce(&mut Translator<'_>) -> Result<(), String>,
) -> Result<FuncId, String> {
    let mut context = module.make_context();
    let pointer = module.target_config().pointer_type();
    context.func.signature.params = vec![AbiParam::new(pointer); parameters];
    let id = module
        .declare_function(name, Linkage::Export, &context.func.signature)
        .map_err(|error| error.to_string())?;
    let mut own = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut context.func, &mut own);
    let block = builder.create_block();
    builder.append_block_params_for_function_params(block);
    builder.switch_to_block(block);
    builder.seal_block(block);
    let mut translator = Translator {
        parameters: builder.block_params(block).to_vec(),
        module,
        builder,
        program,
        layout,
        state,
        fused: has_fused(),
        values: vec![None; program.instructions.len()],
        slots: HashMap::new(),
        pointers: vec![None; layout.len()],
    };
    fill(&mut translator)?;
    translator.builder.ins().return_(&[]);
    translator.builder.finalize();
    module.define_function(id, &mut context).map_err(|error| format!("{error:?}"))?;
    module.clear_context(&mut context);
    Ok(id)
}

/// Constants and functions that the functions of a module share, and the lengths of its inputs.
#[derive(Default)]
struct ModuleState {
    lengths: Vec<usize>,
    constants: Vec<f64>,
    known: HashMap<u64, i32>,
    helpers: HashMap<&'static str, FuncId>,
    tables: usize,
}

struct Translator<'a> {
    module: &'a mut JITModule,
    builder: FunctionBuilder<'a>,
    program: &'a Program,
    layout: &'a Layout,
    state: &'a mut ModuleState,
    /// Inputs, constants, tables, results, further outputs; in the body, then sines and cosines.
    parameters: Vec<Value>,
    fused: bool,
    values: Vec<Option<Value>>,
    /// Indices of the sines and cosines that are computed before the body.
    slots: HashMap<usize, usize>,
    pointers: Vec<Option<Value>>,
}

/// Flags of loads from memory that does not change during a call.
fn constant() -> MemFlags {
    MemFlags::trusted().with_readonly().with_can_move()
}

/// Number of instructions after which an output is computed.
fn output_after(output: Operand) -> usize {
    match output {
        Operand::Value(k) => k + 1,
        _ => 0,
    }
}

/// Byte offset of a number.
fn offset(index: usize) -> Result<i32, String> {
    i32::try_from(8 * index).map_err(|_| "an argument is too long".to_string())
}

impl Translator<'_> {
    /// Writes all but the angles.
    fn body(&mut self, angles: &Angles, slots: HashMap<usize, usize>, results: usize) -> Result<(), String> {
        let program = self.program;
        self.slots = slots;
        // Every result is stored after the last instruction that it depends on.
        let mut ready: Vec<Vec<usize>> = vec![Vec::new(); program.instructions.len() + 1];
        for (k, output) in program.outputs.iter().enumerate() {
            ready[output_after(*output)].push(k);
        }
        self.store(&ready[0], results)?;
        for k in 0..program.instructions.len() {
            if !angles.covered[k] {
                self.instruction(k)?;
            }
            self.store(&ready[k + 1], results)?;
        }
        Ok(())
    }

    /// Writes the angles, their sines and cosines, and the call of the body.
    fn angles(
        &mut self,
        angles: &Angles,
        list: &[Operand],
        padded: usize,
        body: FuncId,
    ) -> Result<(), String> {
        for k in (0..self.program.instructions.len()).filter(|k| angles.before[*k]) {
            self.instruction(k)?;
        }
        let size = u32::try_from(24 * padded).map_err(|_| "too many angles")?;
        let slot = StackSlotData::new(StackSlotKind::ExplicitSlot, size, 4);
        let slot = self.builder.create_sized_stack_slot(slot);
        let pointer = self.module.target_config().pointer_type();
        let address = self.builder.ins().stack_addr(pointer, slot, 0);
        for at in 0..padded {
            // Padding repeats the first angle: no exceptional value slows the others down.
            let angle = self.operand(list[if at < list.len() { at } else { 0 }])?;
            self.builder.ins().store(MemFlags::trusted(), angle, address, offset(at)?);
        }
        let count = self.builder.ins().iconst(types::I64, padded as i64);
        let signature = self.signature(&[pointer, types::I64], None);
        self.call("sines", signature, &[address, count])?;
        let body = self.module.declare_func_in_func(body, self.builder.func);
        let arguments = [&self.parameters[..], &[address]].concat();
        self.builder.ins().call(body, &arguments);
        Ok(())
    }

    fn store(&mut self, outputs: &[usize], results: usize) -> Result<(), String> {
        for k in outputs {
            let value = self.operand(self.program.outputs[*k])?;
            let (base, at) = match *k < results {
                true => (self.parameters[3], *k),
                false => (self.parameters[4], *k - results),
            };
            self.builder.ins().store(MemFlags::trusted(), value, base, offset(at)?);
        }
        Ok(())
    }

    fn operand(&mut self, operand: Operand) -> Result<Value, String> {
        match operand {
            Operand::Const(c) => {
                let next = self.state.constants.len();
                let at = match self.state.known.get(&c.to_bits()) {
                    Some(at) => *at,
                    None => {
                        self.state.constants.push(c);
                        let at = offset(next)?;
                        self.state.known.insert(c.to_bits(), at);
                        at
                    }
                };
                Ok(self.builder.ins().load(types::F64, constant(), self.parameters[1], at))
            }
            Operand::Symbol(symbol) => self.symbol(symbol),
            Operand::Value(k) => {
                if let Some(at) = self.slots.get(&k) {
                    let at = offset(*at)?;
                    return Ok(self.builder.ins().load(types::F64, constant(), self.parameters[5], at));
                }
                self.values[k].ok_or_else(|| "a value is used before it is computed".to_string())
            }
            Operand::Tuple(_) | Operand::Gather(_) => Err("a program has lanes".to_string()),
        }
    }

    fn symbol(&mut self, symbol: Symbol) -> Result<Value, String> {
        let (slot, index) = self.layout.locate(symbol).ok_or("a program reads what it is not given")?;
        let pointer = match self.pointers[slot] {
            Some(pointer) => pointer,
            None => {
                let kind = self.module.target_config().pointer_type();
                let at = offset(slot)?;
                let pointer = self.builder.ins().load(kind, constant(), self.parameters[0], at);
                self.pointers[slot] = Some(pointer);
                pointer
            }
        };
        self.state.lengths[slot] = self.state.lengths[slot].max(index + 1);
        Ok(self.builder.ins().load(types::F64, constant(), pointer, offset(index)?))
    }

    fn instruction(&mut self, k: usize) -> Result<(), String> {
        let op = self.program.instructions[k];
        let mut operands = [None; 3];
        let (mut count, mut failed) = (0, None);
        op.operands(|operand| {
            match self.operand(operand) {
                Ok(value) => operands[count] = Some(value),
                Err(error) => failed = Some(error),
            }
            count += 1;
        });
        if let Some(error) = failed {
            return Err(error);
        }
        let get = |k: usize| operands[k].ok_or_else(|| "an operand is missing".to_string());
        let value = match op {
            Op::Neg(_) => self.builder.ins().fneg(get(0)?),
            Op::Add(..) => self.builder.ins().fadd(get(0)?, get(1)?),
            Op::Sub(..) => self.builder.ins().fsub(get(0)?, get(1)?),
            Op::Mul(..) => self.builder.ins().fmul(get(0)?, get(1)?),
            Op::Div(..) => self.builder.ins().fdiv(get(0)?, get(1)?),
            Op::MulAdd(..) => self.mul_add(get(0)?, get(1)?, get(2)?),
            Op::MulSub(..) if self.fused => {
                let c = self.builder.ins().fneg(get(2)?);
                self.builder.ins().fma(get(0)?, get(1)?, c)
            }
            Op::MulSub(..) => {
                let product = self.builder.ins().fmul(get(0)?, get(1)?);
                self.builder.ins().fsub(product, get(2)?)
            }
            Op::NegMulAdd(..) if self.fused => {
                let a = self.builder.ins().fneg(get(0)?);
                self.builder.ins().fma(a, get(1)?, get(2)?)
            }
            Op::NegMulAdd(..) => {
                let product = self.builder.ins().fmul(get(0)?, get(1)?);
                self.builder.ins().fsub(get(2)?, product)
            }
            Op::Call(Elementary::Sqrt, _) => self.builder.ins().sqrt(get(0)?),
            Op::Call(Elementary::Abs, _) => self.builder.ins().fabs(get(0)?),
            Op::Call(f, _) => self.elementary(f.name(), &[get(0)?])?,
            Op::Atan2(..) => self.elementary("atan2", &[get(0)?, get(1)?])?,
            Op::Pow(..) => self.elementary("pow", &[get(0)?, get(1)?])?,
            Op::Extreme(Extreme::Min, ..) => self.elementary("min", &[get(0)?, get(1)?])?,
            Op::Extreme(Extreme::Max, ..) => self.elementary("max", &[get(0)?, get(1)?])?,
            Op::Table(lookup, ..) => {
                let first = get(0)?;
                self.lookup(lookup, [Some(first), operands[1], operands[2]].map(|x| x.unwrap_or(first)))?
            }
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => return Err("a program has lanes".to_string()),
        };
        self.values[k] = Some(value);
        Ok(())
    }

    fn mul_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        match self.fused {
            true => self.builder.ins().fma(a, b, c),
            false => {
                let product = self.builder.ins().fmul(a, b);
                self.builder.ins().fadd(product, c)
            }
        }
    }

    fn elementary(&mut self, name: &'static str, arguments: &[Value]) -> Result<Value, String> {
        let signature = self.signature(&vec![types::F64; arguments.len()], Some(types::F64));
        self.call(name, signature, arguments)?.ok_or_else(|| "a function has no result".to_string())
    }

    fn lookup(&mut self, lookup: Lookup, x: [Value; 3]) -> Result<Value, String> {
        self.state.tables = self.state.tables.max(lookup.table() + 1);
        let orders = (0..lookup.variables()).fold(0, |all, k| all | lookup.order(k) << (2 * k));
        let pointer = self.module.target_config().pointer_type();
        let table = self.builder.ins().iconst(types::I64, lookup.table() as i64);
        let orders = self.builder.ins().iconst(types::I64, orders as i64);
        let kinds = [pointer, types::I64, types::I64, types::F64, types::F64, types::F64];
        let signature = self.signature(&kinds, Some(types::F64));
        let arguments = [self.parameters[2], table, orders, x[0], x[1], x[2]];
        self.call("lookup", signature, &arguments)?.ok_or_else(|| "a table has no value".to_string())
    }

    fn signature(&self, parameters: &[types::Type], result: Option<types::Type>) -> Signature {
        let mut signature = self.module.make_signature();
        signature.params = parameters.iter().copied().map(AbiParam::new).collect();
        signature.returns = result.into_iter().map(AbiParam::new).collect();
        signature
    }

    fn call(
        &mut self,
        name: &'static str,
        signature: Signature,
        arguments: &[Value],
    ) -> Result<Option<Value>, String> {
        let id = match self.state.helpers.get(name) {
            Some(id) => *id,
            None => {
                let id = self
                    .module
                    .declare_function(name, Linkage::Import, &signature)
                    .map_err(|error| error.to_string())?;
                self.state.helpers.insert(name, id);
                id
            }
        };
        let function = self.module.declare_func_in_func(id, self.builder.func);
        let call = self.builder.ins().call(function, arguments);
        Ok(self.builder.inst_results(call).first().copied())
    }
}

//! Machine code by Cranelift, without its optimiser: the plan has the order of the instructions, and their
//! values are in registers or in memory.

use super::plan::{Allocation, Memory, Place, Step};
use cranelift_codegen::ir::{
    AbiParam, InstBuilder, MemFlags, StackSlotData, StackSlotKind, Type, Value, types,
};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Linkage, Module as _, default_libcall_names};
use linkwork_compiler::expr::{Extreme, Function as Elementary};
use linkwork_compiler::lower::Op;
use std::mem::ManuallyDrop;
use std::sync::OnceLock;

/// Number of registers of values: some are left for operands and results.
pub const REGISTERS: u8 = if cfg!(target_arch = "x86_64") { 13 } else { 28 };

/// Memory of generated code, which is freed on drop.
pub struct Module(ManuallyDrop<JITModule>);

// SAFETY: the module is only used to free its memory on drop, and generated code has no state.
unsafe impl Send for Module {}
// SAFETY: as above.
unsafe impl Sync for Module {}

impl Drop for Module {
    fn drop(&mut self) {
        // SAFETY: the module is not used afterwards, and no call of the code is in progress.
        unsafe { ManuallyDrop::take(&mut self.0).free_memory() }
    }
}

/// Generates the code of a plan; returns its address in a module.
pub fn translate(
    plan: &Allocation,
    results: usize,
    helpers: fn(&str) -> Option<*const u8>,
) -> Result<(Module, *const u8), String> {
    let module = JITModule::new(JITBuilder::with_isa(target()?, default_libcall_names()));
    let mut module = Module(ManuallyDrop::new(module));
    let address = define(&mut module.0, plan, results, helpers)?;
    Ok((module, address))
}

/// The host's instruction set.
fn target() -> Result<OwnedTargetIsa, String> {
    static TARGET: OnceLock<Result<OwnedTargetIsa, String>> = OnceLock::new();
    let make = || {
        let mut flags = settings::builder();
        for (name, value) in [
            ("opt_level", "none"),
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

fn define(
    module: &mut JITModule,
    plan: &Allocation,
    results: usize,
    helpers: fn(&str) -> Option<*const u8>,
) -> Result<*const u8, String> {
    let mut context = module.make_context();
    let pointer = module.target_config().pointer_type();
    context.func.signature.params = vec![AbiParam::new(pointer); 5];
    let id = module
        .declare_function("program", Linkage::Export, &context.func.signature)
        .map_err(|error| error.to_string())?;
    let mut own = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut context.func, &mut own);
    let block = builder.create_block();
    builder.append_block_params_for_function_params(block);
    builder.switch_to_block(block);
    builder.seal_block(block);
    let size = u32::try_from(8 * (plan.work + 3 * plan.angles)).map_err(|_| "too many values")?;
    let slot = builder.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, size, 4));
    let mut translator = Translator {
        parameters: builder.block_params(block).to_vec(),
        frame: builder.ins().stack_addr(pointer, slot, 0),
        builder,
        pointer,
        plan,
        results,
        helpers,
        registers: vec![None; REGISTERS.into()],
        inputs: vec![None; plan.lengths.len()],
    };
    plan.steps.iter().try_for_each(|step| translator.step(*step))?;
    let Translator { mut builder, .. } = translator;
    builder.ins().return_(&[]);
    builder.finalize();
    module.define_function(id, &mut context).map_err(|error| format!("{error:?}"))?;
    module.clear_context(&mut context);
    module.finalize_definitions().map_err(|error| error.to_string())?;
    Ok(module.get_finalized_function(id))
}

struct Translator<'a> {
    builder: FunctionBuilder<'a>,
    pointer: Type,
    plan: &'a Allocation,
    results: usize,
    helpers: fn(&str) -> Option<*const u8>,
    /// Inputs, constants, tables, results, further outputs.
    parameters: Vec<Value>,
    /// Address of the work space, which the angles follow.
    frame: Value,
    /// Values in registers.
    registers: Vec<Option<Value>>,
    /// Addresses of the inputs.
    inputs: Vec<Option<Value>>,
}

impl Translator<'_> {
    fn step(&mut self, step: Step) -> Result<(), String> {
        match step {
            Step::Load(to, from, _) => {
                let value = self.load(from)?;
                self.registers[usize::from(to)] = Some(value);
            }
            Step::Store(from, to, _) => {
                let value = self.value(Place::Register(from))?;
                self.store(value, to)?;
            }
            Step::Copy(from, to, _) => {
                let value = self.load(from)?;
                self.store(value, to)?;
            }
            Step::StoreSecond(..) => return Err("a program has lanes".to_string()),
            Step::Fill(constant, first, count) => {
                let value = self.load(Memory::Constant(constant))?;
                (first..first + count).try_for_each(|k| self.store(value, Memory::Output(k)))?;
            }
            Step::Operation(op, to, places, _) => {
                let value = self.operation(op, places)?;
                self.registers[usize::from(to)] = Some(value);
            }
            Step::Sines => {
                let (base, at) = self.address(Memory::Angle(0))?;
                let array = self.builder.ins().iadd_imm(base, i64::from(at));
                let count = self.builder.ins().iconst(types::I64, self.plan.angles as i64);
                self.call("sines", &[array, count], None)?;
            }
        }
        Ok(())
    }

    fn operation(&mut self, op: Op, [a, b, c]: [Place; 3]) -> Result<Value, String> {
        let a = self.value(a)?;
        Ok(match op {
            Op::Neg(_) => self.builder.ins().fneg(a),
            Op::Call(Elementary::Sqrt, _) => self.builder.ins().sqrt(a),
            Op::Call(Elementary::Abs, _) => self.builder.ins().fabs(a),
            Op::Call(f, _) => self.number(f.function_name(), &[a])?,
            Op::Add(..) => {
                let b = self.value(b)?;
                self.builder.ins().fadd(a, b)
            }
            Op::Sub(..) => {
                let b = self.value(b)?;
                self.builder.ins().fsub(a, b)
            }
            Op::Mul(..) => {
                let b = self.value(b)?;
                self.builder.ins().fmul(a, b)
            }
            Op::Div(..) => {
                let b = self.value(b)?;
                self.builder.ins().fdiv(a, b)
            }
            Op::MulAdd(..) | Op::MulSub(..) | Op::NegMulAdd(..) => {
                let [b, c] = [self.value(b)?, self.value(c)?];
                let [a, c] = match op {
                    Op::MulSub(..) => [a, self.builder.ins().fneg(c)],
                    Op::NegMulAdd(..) => [self.builder.ins().fneg(a), c],
                    _ => [a, c],
                };
                self.builder.ins().fma(a, b, c)
            }
            Op::Atan2(..) | Op::Pow(..) | Op::Extreme(..) => {
                let b = self.value(b)?;
                let name = match op {
                    Op::Atan2(..) => "atan2",
                    Op::Pow(..) => "pow",
                    Op::Extreme(Extreme::Min, ..) => "min",
                    _ => "max",
                };
                self.number(name, &[a, b])?
            }
            Op::Table(lookup, ..) => {
                let [y, z] = [self.value(b)?, self.value(c)?];
                let orders = (0..lookup.variable_count())
                    .fold(0, |all, k| all | lookup.derivative_order(k) << (2 * k));
                let table = self.builder.ins().iconst(types::I64, lookup.table_index() as i64);
                let orders = self.builder.ins().iconst(types::I64, orders as i64);
                self.number("lookup", &[self.parameters[2], table, orders, a, y, z])?
            }
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => return Err("a program has lanes".to_string()),
        })
    }

    fn value(&mut self, place: Place) -> Result<Value, String> {
        match place {
            Place::Register(register) => {
                let value = self.registers[usize::from(register)];
                value.ok_or_else(|| "a register has no value".to_string())
            }
            Place::Memory(memory) => self.load(memory),
        }
    }

    fn load(&mut self, from: Memory) -> Result<Value, String> {
        let (base, at) = self.address(from)?;
        Ok(self.builder.ins().load(types::F64, MemFlags::trusted(), base, at))
    }

    fn store(&mut self, value: Value, to: Memory) -> Result<(), String> {
        let (base, at) = self.address(to)?;
        self.builder.ins().store(MemFlags::trusted(), value, base, at);
        Ok(())
    }

    fn address(&mut self, memory: Memory) -> Result<(Value, i32), String> {
        let (base, index) = match memory {
            Memory::Constant(k) => (self.parameters[1], k),
            Memory::Work(k) => (self.frame, k),
            Memory::Angle(k) => (self.frame, self.plan.work + k),
            Memory::Output(k) if k < self.results => (self.parameters[3], k),
            Memory::Output(k) => (self.parameters[4], k - self.results),
            Memory::Input(slot, index) => {
                let base = self.inputs[slot].unwrap_or_else(|| {
                    let (flags, at) = (MemFlags::trusted(), 8 * slot as i32);
                    self.builder.ins().load(self.pointer, flags, self.parameters[0], at)
                });
                self.inputs[slot] = Some(base);
                (base, index)
            }
        };
        let offset = i32::try_from(8 * index).map_err(|_| "an argument is too long".to_string())?;
        Ok((base, offset))
    }

    fn number(&mut self, name: &str, arguments: &[Value]) -> Result<Value, String> {
        let result = self.call(name, arguments, Some(types::F64))?;
        result.ok_or_else(|| "a function has no result".to_string())
    }

    /// Calls a function, after which no value is in a register.
    fn call(
        &mut self,
        name: &str,
        arguments: &[Value],
        result: Option<Type>,
    ) -> Result<Option<Value>, String> {
        let address = (self.helpers)(name).ok_or("a function is missing")?;
        let mut signature = self.builder.func.signature.clone();
        let kind = |value: &Value| AbiParam::new(self.builder.func.dfg.value_type(*value));
        signature.params = arguments.iter().map(kind).collect();
        signature.returns = result.into_iter().map(AbiParam::new).collect();
        let signature = self.builder.import_signature(signature);
        let address = self.builder.ins().iconst(self.pointer, address as i64);
        let call = self.builder.ins().call_indirect(signature, address, arguments);
        self.inputs.fill(None);
        Ok(self.builder.inst_results(call).first().copied())
    }
}

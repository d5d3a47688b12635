//! Translation of straight-line programs to WebAssembly.
//!
//! A module imports its memory and the elementary functions that WebAssembly has no instruction for. Each
//! exported function takes the addresses of its inputs, then the address of its result.

use crate::layout::InputLayout;
use linkwork_compiler::expr::{Extreme, Function as Elementary, Lookup, Symbol};
use linkwork_compiler::lower::{Op, Operand, Program};

const I32: u8 = 0x7f;
const F64: u8 = 0x7c;

const END: u8 = 0x0b;
const CALL: u8 = 0x10;
const GET: u8 = 0x20;
const SET: u8 = 0x21;
const LOAD: u8 = 0x2b;
const STORE: u8 = 0x39;
const INTEGER: u8 = 0x41;
const NUMBER: u8 = 0x44;
const ABS: u8 = 0x99;
const NEG: u8 = 0x9a;
const SQRT: u8 = 0x9f;
const ADD: u8 = 0xa0;
const SUB: u8 = 0xa1;
const MUL: u8 = 0xa2;
const DIV: u8 = 0xa3;
const MIN: u8 = 0xa4;
const MAX: u8 = 0xa5;

/// Maximum nesting depth of operations whose results stay on the stack of WebAssembly.
const DEPTH: usize = 32;

/// WebAssembly module under construction.
#[derive(Default)]
pub struct BinaryModule {
    types: Vec<(Vec<u8>, Vec<u8>)>,
    /// Name and type index of each imported function.
    imports: Vec<(String, usize)>,
    /// Name, type index and code of each exported function.
    functions: Vec<(String, usize, Vec<u8>)>,
}

impl BinaryModule {
    /// Adds a program to the WebAssembly module, as a function with a name.
    ///
    /// # Errors
    ///
    /// The program has lanes, or reads values that are no inputs of the layout.
    pub fn add(&mut self, name: &str, program: &Program, layout: &InputLayout) -> Result<(), String> {
        let kind = self.find_or_add_type(vec![I32; layout.len() + 1], Vec::new());
        let mut writer = FunctionBodyWriter {
            module: self,
            program,
            layout,
            code: Vec::new(),
            values: vec![ResultLocation::Missing; program.instructions.len()],
            locals: 0,
        };
        writer.write_body()?;
        let (code, locals) = (writer.code, writer.locals);
        let mut body = Vec::new();
        match locals {
            0 => body.push(0),
            count => {
                body.push(1);
                write_unsigned(&mut body, count);
                body.push(F64);
            }
        }
        body.extend(code);
        body.push(END);
        self.functions.push((name.to_string(), kind, body));
        Ok(())
    }

    /// Returns the binary encoding of the WebAssembly module.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let mut out = b"\0asm\x01\0\0\0".to_vec();
        let mut types = Vec::new();
        for (parameters, results) in &self.types {
            types.push(0x60);
            for list in [parameters, results] {
                write_unsigned(&mut types, list.len());
                types.extend(list);
            }
        }
        write_section(&mut out, 1, self.types.len(), &types);
        let mut imports = Vec::new();
        write_length_prefixed_name(&mut imports, "m");
        write_length_prefixed_name(&mut imports, "memory");
        imports.extend([2, 0, 1]);
        for (name, kind) in &self.imports {
            write_length_prefixed_name(&mut imports, "m");
            write_length_prefixed_name(&mut imports, name);
            imports.push(0);
            write_unsigned(&mut imports, *kind);
        }
        write_section(&mut out, 2, self.imports.len() + 1, &imports);
        let (mut kinds, mut exports, mut code) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (name, kind, body)) in self.functions.iter().enumerate() {
            write_unsigned(&mut kinds, *kind);
            write_length_prefixed_name(&mut exports, name);
            exports.push(0);
            write_unsigned(&mut exports, self.imports.len() + k);
            write_unsigned(&mut code, body.len());
            code.extend(body);
        }
        write_section(&mut out, 3, self.functions.len(), &kinds);
        write_section(&mut out, 7, self.functions.len(), &exports);
        write_section(&mut out, 10, self.functions.len(), &code);
        out
    }

    /// Returns the index of a function type, which is added to the module if it is new.
    fn find_or_add_type(&mut self, parameters: Vec<u8>, results: Vec<u8>) -> usize {
        let kind = (parameters, results);
        find_or_append(&mut self.types, kind)
    }

    /// Returns the index of an imported function with these parameters, which is added if it is new.
    fn import_function(&mut self, name: &str, parameters: Vec<u8>) -> usize {
        let kind = self.find_or_add_type(parameters, vec![F64]);
        find_or_append(&mut self.imports, (name.to_string(), kind))
    }
}

/// Returns the index of an entry of a list, to which it is appended if it is absent.
fn find_or_append<T: PartialEq>(list: &mut Vec<T>, entry: T) -> usize {
    list.iter().position(|known| *known == entry).unwrap_or_else(|| {
        list.push(entry);
        list.len() - 1
    })
}

/// Location of an instruction's result in the generated WebAssembly code.
#[derive(Clone, Copy, PartialEq)]
enum ResultLocation {
    Missing,
    Local(usize),
    /// The result is computed where it is used, with operations nested this deep.
    Nested(usize),
}

struct FunctionBodyWriter<'a> {
    module: &'a mut BinaryModule,
    program: &'a Program,
    layout: &'a InputLayout,
    code: Vec<u8>,
    values: Vec<ResultLocation>,
    locals: usize,
}

impl FunctionBodyWriter<'_> {
    fn write_body(&mut self) -> Result<(), String> {
        let program = self.program;
        for (k, op) in program.instructions.iter().enumerate() {
            let mut depth = 1;
            op.visit_operands(|operand| {
                if let Operand::Value(a) = operand
                    && let ResultLocation::Nested(nested) = self.values[a]
                {
                    depth = depth.max(nested + 1);
                }
            });
            if program.uses.get(k) == Some(&1) && depth < DEPTH {
                self.values[k] = ResultLocation::Nested(depth);
                continue;
            }
            self.write_instruction(k)?;
            self.values[k] = ResultLocation::Local(self.locals);
            self.code.push(SET);
            let local = self.local_index(self.locals);
            write_unsigned(&mut self.code, local);
            self.locals += 1;
        }
        for (k, output) in program.outputs.iter().enumerate() {
            self.code.push(GET);
            write_unsigned(&mut self.code, self.layout.len());
            self.write_operand(*output)?;
            self.code.extend([STORE, 3]);
            write_unsigned(&mut self.code, 8 * k);
        }
        Ok(())
    }

    /// Returns the index of a local variable in WebAssembly, whose numbering begins with the parameters.
    fn local_index(&self, index: usize) -> usize {
        self.layout.len() + 1 + index
    }

    /// Writes the code that puts the result of an instruction on the stack.
    fn write_instruction(&mut self, k: usize) -> Result<(), String> {
        match self.program.instructions[k] {
            Op::Neg(a) => self.write_operation(&[a], NEG),
            Op::Add(a, b) => self.write_operation(&[a, b], ADD),
            Op::Sub(a, b) => self.write_operation(&[a, b], SUB),
            Op::Mul(a, b) => self.write_operation(&[a, b], MUL),
            Op::Div(a, b) => self.write_operation(&[a, b], DIV),
            Op::Extreme(Extreme::Min, a, b) => self.write_operation(&[a, b], MIN),
            Op::Extreme(Extreme::Max, a, b) => self.write_operation(&[a, b], MAX),
            Op::MulAdd(a, b, c) => {
                self.write_operation(&[a, b], MUL)?;
                self.write_operation(&[c], ADD)
            }
            Op::MulSub(a, b, c) => {
                self.write_operation(&[a, b], MUL)?;
                self.write_operation(&[c], SUB)
            }
            Op::NegMulAdd(a, b, c) => {
                self.write_operand(c)?;
                self.write_operation(&[a, b], MUL)?;
                self.code.push(SUB);
                Ok(())
            }
            Op::Call(Elementary::Sqrt, a) => self.write_operation(&[a], SQRT),
            Op::Call(Elementary::Abs, a) => self.write_operation(&[a], ABS),
            Op::Call(f, a) => self.write_call(f.function_name(), &[a]),
            Op::Atan2(a, b) => self.write_call("atan2", &[a, b]),
            Op::Pow(a, b) => self.write_call("pow", &[a, b]),
            Op::Table(lookup, a, b, c) => self.write_table_lookup(lookup, [a, b, c]),
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => Err("a program has lanes".to_string()),
        }
    }

    fn write_operation(&mut self, operands: &[Operand], operation: u8) -> Result<(), String> {
        operands.iter().try_for_each(|operand| self.write_operand(*operand))?;
        self.code.push(operation);
        Ok(())
    }

    fn write_call(&mut self, name: &str, operands: &[Operand]) -> Result<(), String> {
        operands.iter().try_for_each(|operand| self.write_operand(*operand))?;
        let function = self.module.import_function(name, vec![F64; operands.len()]);
        self.code.push(CALL);
        write_unsigned(&mut self.code, function);
        Ok(())
    }

    /// Writes the lookup of an interpolation table: its index, orders of differentiation of two bits each,
    /// and three variables, of which a table may use fewer.
    fn write_table_lookup(&mut self, lookup: Lookup, variables: [Operand; 3]) -> Result<(), String> {
        let count = lookup.variable_count();
        let orders = (0..count).fold(0, |all, k| all | lookup.derivative_order(k) << (2 * k));
        for integer in [lookup.table_index(), orders] {
            self.code.push(INTEGER);
            write_signed(&mut self.code, integer);
        }
        for (k, variable) in variables.into_iter().enumerate() {
            self.write_operand(if k < count { variable } else { Operand::Const(0.0) })?;
        }
        let function = self.module.import_function("lookup", vec![I32, I32, F64, F64, F64]);
        self.code.push(CALL);
        write_unsigned(&mut self.code, function);
        Ok(())
    }

    fn write_operand(&mut self, operand: Operand) -> Result<(), String> {
        match operand {
            Operand::Const(x) => {
                self.code.push(NUMBER);
                self.code.extend(x.to_le_bytes());
            }
            Operand::Symbol(symbol) => self.write_load_of_symbol(symbol)?,
            Operand::Value(k) => match self.values[k] {
                ResultLocation::Local(local) => {
                    self.code.push(GET);
                    let local = self.local_index(local);
                    write_unsigned(&mut self.code, local);
                }
                ResultLocation::Nested(_) => self.write_instruction(k)?,
                ResultLocation::Missing => return Err("a value is used before it is computed".to_string()),
            },
            Operand::Tuple(_) | Operand::Gather(_) => return Err("a program has lanes".to_string()),
        }
        Ok(())
    }

    fn write_load_of_symbol(&mut self, symbol: Symbol) -> Result<(), String> {
        let (slot, index) =
            self.layout.locate_symbol(symbol).ok_or("a program reads what it is not given")?;
        self.code.push(GET);
        write_unsigned(&mut self.code, slot);
        self.code.extend([LOAD, 3]);
        write_unsigned(&mut self.code, 8 * index);
        Ok(())
    }
}

/// Writes an unsigned integer in the variable-length encoding LEB128.
fn write_unsigned(out: &mut Vec<u8>, mut x: usize) {
    while x >= 0x80 {
        out.push((x & 0x7f) as u8 | 0x80);
        x >>= 7;
    }
    out.push(x as u8);
}

/// Writes a nonnegative integer in the signed variable-length encoding LEB128.
fn write_signed(out: &mut Vec<u8>, mut x: usize) {
    while x >= 0x40 {
        out.push((x & 0x7f) as u8 | 0x80);
        x >>= 7;
    }
    out.push(x as u8);
}

/// Writes a name, preceded by its length.
fn write_length_prefixed_name(out: &mut Vec<u8>, name: &str) {
    write_unsigned(out, name.len());
    out.extend(name.bytes());
}

/// Writes a section of a WebAssembly module: its number, its length, and a list with this number of entries.
fn write_section(out: &mut Vec<u8>, number: u8, count: usize, entries: &[u8]) {
    let mut list = Vec::new();
    write_unsigned(&mut list, count);
    list.extend(entries);
    out.push(number);
    write_unsigned(out, list.len());
    out.extend(list);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the examples of LEB128 in the WebAssembly specification and in DWARF, appendix C.
    #[test]
    fn integers_have_variable_lengths() {
        let encoded_integer = |write: fn(&mut Vec<u8>, usize), x: usize| {
            let mut out = Vec::new();
            write(&mut out, x);
            out
        };
        assert_eq!(encoded_integer(write_unsigned, 624_485), [0xe5, 0x8e, 0x26]);
        assert_eq!(encoded_integer(write_unsigned, 127), [0x7f]);
        assert_eq!(encoded_integer(write_signed, 127), [0xff, 0]);
        assert_eq!(encoded_integer(write_signed, 2), [2]);
    }
}
